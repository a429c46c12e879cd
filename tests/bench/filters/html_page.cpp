#include "tests/bench/filters/html_page.h"

namespace tessera::tools::bench {

std::string_view page_style() {
    return R"(
:root { color-scheme: light; }
body { font: 15px/1.45 system-ui, sans-serif; color: #222; max-width: 1180px; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.6em; } h2 { margin-top: 2em; border-bottom: 1px solid #ccc; } h3 { margin-bottom: .3em; }
table { border-collapse: collapse; margin: .6em 0; font-size: 13px; }
th, td { padding: .15em .6em; text-align: right; border-bottom: 1px solid #e4e4e4; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
tr.first td { border-top: 2px solid #999; }
td.best { font-weight: bold; background: #e4f3e4; } td.bad { color: #b00020; }
figure { margin: 0; display: inline-block; } figcaption { font-size: 12px; }
.crops { display: flex; flex-wrap: wrap; gap: 8px; }
.crops img { width: 256px; image-rendering: pixelated; display: block; }
.plots { display: flex; flex-wrap: wrap; gap: 12px; } .plots svg { width: 560px; max-width: 100%; }
svg text { font: 11px system-ui, sans-serif; fill: #333; } svg text.title { font-size: 13px; font-weight: bold; }
svg .grid { stroke: #e2e2e2; } svg .line path { stroke-width: 1.6; } svg .line circle { stroke: none; }
svg .line:hover path { stroke-width: 4; }
.legend span { display: inline-block; margin-right: 1.1em; font-size: 13px; }
.legend i { display: inline-block; width: 1.6em; height: .25em; vertical-align: middle; margin-right: .35em; }
.note { color: #555; font-size: 13px; } .scroll { overflow-x: auto; }
#stage { position: relative; width: 1024px; max-width: 100%; user-select: none; touch-action: none; cursor: ew-resize; }
#stage img { display: block; width: 100%; image-rendering: pixelated; pointer-events: none; }
#stage img.over { position: absolute; inset: 0; }
#stage b { position: absolute; top: 0; bottom: 0; width: 2px; background: #fff; box-shadow: 0 0 2px #000; }
#stage span { position: absolute; bottom: 4px; background: #000a; color: #fff; padding: 0 .4em; font-size: 12px; }
#controls select, #controls input { font: inherit; margin-right: 1em; } #split { width: 320px; vertical-align: middle; }
)";
}

std::string_view page_script() {
    return R"(
const crops = [...document.querySelectorAll('img[data-filter]')];
const pick = name => document.getElementById(name), distinct = list => [...new Set(list)];
function fill(select, values) {
    const before = select.value;
    select.replaceChildren(...values.map(value => new Option(value, value)));
    if (values.includes(before)) select.value = before;
}
function find(filter) {
    return crops.find(c => c.dataset.scene === pick('scene').value && c.dataset.filter === filter &&
        (filter === 'reference' || c.dataset.spp === pick('spp').value));
}
function show() {
    const of_scene = crops.filter(c => c.dataset.scene === pick('scene').value);
    fill(pick('spp'), distinct(of_scene.map(c => c.dataset.spp).filter(Boolean)));
    const filters = distinct(of_scene.map(c => c.dataset.filter));
    fill(pick('left'), filters.filter(f => f !== 'reference').concat('reference'));
    fill(pick('right'), ['reference'].concat(filters.filter(f => f !== 'reference')));
    const left = find(pick('left').value), right = find(pick('right').value), split = pick('split').value;
    if (!left || !right) return;
    pick('under').src = right.src;
    pick('over').src = left.src;
    pick('over').style.clipPath = `inset(0 ${100 - split}% 0 0)`;
    pick('bar').style.left = split + '%';
    pick('name-left').textContent = left.alt;
    pick('name-right').textContent = right.alt;
}
for (const name of ['scene', 'spp', 'left', 'right', 'split']) pick(name).addEventListener('input', show);
function drag(event) {
    if (event.type === 'pointermove' && event.buttons === 0) return;
    const box = pick('stage').getBoundingClientRect();
    pick('split').value = 100 * (event.clientX - box.left) / box.width;
    show();
}
pick('stage').addEventListener('pointerdown', drag);
pick('stage').addEventListener('pointermove', drag);
fill(pick('scene'), distinct(crops.map(c => c.dataset.scene)));
show();
if (pick('spp').querySelector('option[value="4"]')) pick('spp').value = '4';
show();
)";
}

}  // namespace tessera::tools::bench
