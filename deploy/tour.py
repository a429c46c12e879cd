"""The Python client of deploy/tour.sh: drags a colour, adds a lamp, renders a picture. Usage: tour.py ENDPOINT KEYS PICTURE"""

import math
import sys

import tessera

endpoint, keys, picture = sys.argv[1:]
with tessera.connect(endpoint, keys=keys, name="python") as session:
    scene = session.join("studio")
    paint = scene["materials/paint"]
    drag = session.new_edit_group()
    for step in range(40):  # one transaction, for undo
        with session.transaction(edit_group=drag) as edit:
            wave = 0.5 + 0.4 * math.sin(0.16 * step)
            edit.set(paint, base_color=(wave, 0.2, 1.0 - wave, 1.0))
    with session.transaction() as edit:
        lamp = edit.create("light", name="lamp", kind="point", intensity=(20.0, 16.0, 10.0))
        matrix = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1.5, 2.0, 1.5, 1)
        edit.create("transform", name="lamp position", matrix=matrix, children=[lamp])
    view = session.open_view("cameras/camera", size=(640, 360), spp=32)
    view.wait(samples=32).save(picture)
    hit = view.pick(320, 180)
    print("at the centre:", f"object {hit.object} at {hit.position}" if hit else "nothing")
