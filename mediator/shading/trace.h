#ifndef TESSERA_MEDIATOR_SHADING_TRACE_H
#define TESSERA_MEDIATOR_SHADING_TRACE_H

#include "mediator/shading/camera.h"
#include "mediator/shading/coverage.h"
#include "mediator/shading/shadow_catcher.h"
#include "mediator/shading/speculars.h"

// One sample, a pure function of (scene, view, pixel, index); of its context's time that is sample_time.
//
// Path tracing: unidirectional; Russian roulette from the fourth vertex on, by the largest component of the
// throughput. The renderer Whitted: emission and sky along all branches of perfect speculars, and where one
// ends on a surface direct light, as path tracing finds it with max_bounces = 0; the features of a sample are
// the branches' by their weights, the normal by their probabilities. The range is that of all branches in
// both. The renderer Raster is Whitted from first hits that a rasteriser has found (raster.h). The renderer
// Coverage finds the first hit alone.
//
// All rays but those to lights are asked for at one place and shaded at one place: a shader has all its
// functions inlined, and what is written twice is compiled twice. The including side says whether its views
// may ask for trees of perfect speculars (the renderer Whitted, or the range):
//   bool has_specular_trees(IN(Context) context)
SHADING_BEGIN

inline constexpr uint RouletteFrom = 3u;  // vertices that are never cut short
// From here on nothing goes on for certain: a path that perfect mirrors or total reflection keep inside of a
// body has to end. Diffuse paths do not come so far: albedo 0.99 survives 1024 times in 30,000.
inline constexpr uint NothingCertainFrom = 1024u;

// Light finds its way out of dense media, slowly: of paths in a half space that absorbs nothing, one in
// sqrt(pi n) is scattered more than n times.
inline constexpr uint NothingCertainInMediaFrom = 65536u;

inline bool survives(INOUT(Path) path, uint nothing_certain_from, float choice) {
    if (path.vertex >= RouletteFrom) {
        const float most = path.vertex >= nothing_certain_from ? 0.95f : 1.0f;
        const float probability = lesser_of(largest(path.throughput), most);
        if (!(choice < probability)) return false;
        path.throughput /= probability;
    }
    return largest(path.throughput) > 0.0f;
}

// From a hit to the next ray; false: there is none.
WITH_CONTEXT inline bool leave_vertex(IN(Context) context, INOUT(Path) path, INOUT(Ray) ray,
                                      INOUT(uint) stage, IN(Surface) surface, IN(LegLight) leg,
                                      INOUT(Connection) connection) {
    add_emission(context, path, ray, surface);
    if (stage == StageGather) return false;
    Lobe lobe = rough_lobe(path);
    if (stage == StagePath) {
        lobe = choose_lobe(path, surface, lobe);
        if (lobe.kind == LobeNone) return false;
    } else {
        if (!(surface.rough_share > 0.0f)) return false;
        path.probability *= lobe_chances(surface).rough;
    }
    if (lobe.kind == LobeRough && path.way.scatterings == 0u && !leg.is_aside) {
        path.found.albedo += surface.albedo * surface.rough_share * path.throughput;
        if (!is_in_medium(surface)) path.found.normal += path.probability * surface.frame[2];
    }
    if (!surface.scatters) return false;
    if (stage == StagePath && !leg.is_aside && path.vertex >= context.view.max_scatterings) return false;
    vec3 direction = vec3(0.0f);
    if (lobe.kind == LobeRough) {
        const vec3 wo = to_local(surface, -ray.direction);
        add_lights(context, path, surface, wo, leg, connection);
        if (leg.is_aside) return true;
        if (!scatter(context.scene.energy, context.view, path, surface, wo, lobe, direction)) return false;
    } else {
        direction = pass_on(context, path, surface, lobe);
    }
    if (stage == StagePath) {
        const uint end = is_in_medium(surface) ? NothingCertainInMediaFrom : NothingCertainFrom;
        if (!survives(path, end, lobe.roulette)) return false;
    } else {
        stage = StageGather;
    }
    ray = leaving(surface, direction);
    path.inside = inside_after(context.scene, path.inside, surface, direction);
    path.vertex += 1u;
    return true;
}

// What the camera sees, where that is known before the sample is traced; its instance may be NoInstance.
struct FirstHit {
    bool is_known;
    Hit hit;
};

WITH_CONTEXT inline Path trace_from(IN(Context) context, Path path, Ray ray, IN(FirstHit) seen) {
    const bool covers = context.view.renderer == RendererCoverage;
    const bool whitted =
        has_specular_trees(context) && context.view.renderer != RendererPathTracing && !covers;
    const bool wants_range = has_specular_trees(context) && keeps(context.view, KeepsRange);
    const bool has_media = (context.scene.features & FeatureMedia) != 0u;
    const bool opens = (context.scene.features & FeatureOpenMedia) != 0u;
    const bool scatters = (context.scene.features & FeatureScattering) != 0u;
    tell_camera(context, ray);
    const Ray camera = ray;
    bool is_caught = false;  // by a shadow catcher, and has met nothing since
    path.cone = camera_cone(context.view, ray, path.numbers.index);
    if (has_media) path.inside = context.view.inside;
    Branch branch = root_branch(ray, path.cone);
    BranchStack open;
    open.count = 0u;
    uint stage = whitted ? StageBranch : StagePath;
    Connection connection = no_connection();
    Course course = new_course(ray.origin);
    Held held = hold_nothing();
    bool first = true;  // nothing has been met
    bool passes = false;
    while (true) {
        const bool connects = opens && connection.is_open;
        // The tree of a path is followed, after the path itself, for its range alone.
        const bool lit = !covers && (whitted || stage == StagePath);
        const bool resumes = scatters && held.is_on && !connects;
        const uint seed = connects ? connection.seed : closest_seed(path);
        Hit hit;
        bool is_hit = false;
        if (resumes) {
            hit = held.hit;
            is_hit = held.is_hit;
        } else {
            path.rays += 1u;
            if (path.rays == 1u && seen.is_known) {
                hit = seen.hit;
                is_hit = hit.instance != NoInstance;
            } else {
                is_hit = trace_closest(context, ray, seed, course.skip, hit);
            }
        }
        const bool is_boundary = opens && is_hit && passes_boundary(context.scene, hit, seed);
        if (opens && !resumes) come_through(context.scene, course, path.inside, is_hit && !is_boundary, hit);
        const float length = is_hit ? hit.distance : infinity();
        const bool arrives = connects && (connection.distant ? !is_hit : !(length < 1.0f));
        Leg leg = clear_leg();
        const bool is_clear = !has_media || path.inside.x == NoInstance;
        LegLight leg_light = no_leg_light();
        if (resumes) {
            leg = held.leg;
            leg_light = held.light;
            held.is_on = false;
        } else if (!is_clear && (connects || lit)) {
            const uint kind =
                connects ? LegPasses : leg_kind(path, stage, passes, context.view.max_scatterings);
            if (lit) leg_light = light_leg(context, path, ray, course, length, kind);
            leg = leg_of(context, path, ray, course, arrives && !connection.distant ? 1.0f : length, kind,
                         leg_light.is_aside ? leg_light.distance : -1.0f);
            if (!(leg_light.is_aside && largest(leg.aside) > 0.0f)) {
                leg_light = at_own_place(leg_light, leg.distance, leg.density);
            }
        }
        const bool is_aside = scatters && leg_light.is_aside;
        if (!connects && lit && !is_aside) {
            if (!is_caught && !passes) add_shapes(context, path, ray, course.begun, length);
            if (!is_clear && largest(leg.emitted) > 0.0f && !passes) {
                add_light(path.found, context.view, path.throughput * leg.emitted, path.way);
            }
        }
        const bool goes_through = is_boundary && !arrives && !leg.scatters && !is_aside;
        const float before = course.begun;
        if (goes_through) go_through(context.scene, course, path.inside, hit, ray, context.time);
        bool goes_on = goes_through;
        if (connects) {
            if (!is_clear) connection.light *= leg.passed;
            if (arrives) {
                receive_light(context, path.found, connection.light, connection.intensity, connection.way,
                              unit_vector(ray.direction));
            }
            if (!goes_through) {
                goes_on = go_on_with_path(connection, path, ray);
                course = new_course(ray.origin);
                if (scatters && held.is_on) course = held.course;
            }
        } else {
            if (is_aside) {
                held = Held(true, is_hit, hit, leg, at_own_place(leg_light, leg.distance, leg.density),
                            course, path.throughput, path.vertex);
                leg_light.density = leg.aside_density;
                path.vertex = aside_vertex(path.vertex, course.number);
                path.throughput *= leg.aside / leg_light.pdf;
            } else if (leg.scatters) {
                if (stage == StageBranch) {
                    push_rest(open, branch, path, ray, course, first);
                    path.vertex += MediumVertex;
                }
                path.throughput *= leg.scattered;
            } else {
                if (!is_clear) path.throughput *= leg.passed;
                if (stage == StageBranch) branch.weight = path.throughput;
            }
            const bool in_medium = is_aside || leg.scatters;
            const float along = is_aside ? leg_light.distance : leg.distance;
            if (!is_aside) passes = false;
            const float distance = in_medium ? course.begun + along : length;
            if (goes_through) {
                path.cone.width += path.cone.spread * (distance - before);
            } else if (is_hit && covers) {
                show_object(path.found, context.scene.instances.items[hit.instance].object,
                            depth_along(context.view, ray, distance));
            } else if (is_hit || in_medium) {
                if (!is_aside) path.cone.width += path.cone.spread * (distance - course.begun);
                // At once: a surface is large, and to copy it takes longer than to skip all that it does not
                // have.
                const Surface surface =
                    in_medium ? scattering_place(
                                    course.start + along * ray.direction, ray.direction, leg.anisotropy,
                                    context.scene.instances.items[path.inside.x].object, context.time)
                              : make_surface(context.scene, hit, ray.direction, path.cone.width, path.inside,
                                             context.time);
                tell_hit(context, surface, path.throughput);
                const bool on_the_way = is_aside || (leg.scatters && stage == StageBranch);
                if (first && !on_the_way) {
                    const bool moves = (context.scene.features & FeatureCameraMotion) != 0u;
                    path.found.depth =
                        moves ? moving_depth_along(context.view, context.time, ray.direction, distance)
                              : depth_along(context.view, ray, distance);
                    path.found.object = surface.object;
                    path.found.alpha = 1.0f;
                }
                const bool catches_path = catches(context.scene, surface);
                if (catches_path && is_caught) {
                    show_background(context, path, camera);
                } else if (catches_path && first) {
                    is_caught = true;
                    goes_on = true;
                    ray = caught(path, surface);
                    if (stage == StageBranch) stage = StageGather;
                } else if (catches_path) {
                    goes_on = pass_catcher(context, path, ray, surface);
                } else {
                    if (!is_aside) is_caught = false;
                    if (!in_medium && (stage == StageBranch || (first && wants_range))) {
                        if (wants_range) path.found.range += range_at(branch, surface);
                        push_children(open, context.scene, branch, path.cone, path.inside, surface,
                                      channel_of(path.numbers));
                    }
                    if (!in_medium) leg_light = no_leg_light();
                    if (lit) {
                        goes_on = leave_vertex(context, path, ray, stage, surface, leg_light, connection);
                    }
                    if (is_aside) {
                        path.throughput = held.throughput;
                        path.vertex = held.vertex;
                        goes_on = true;
                    }
                    if (opens && connection.is_open) {
                        goes_on = look_for_light(connection, path, ray, goes_on);
                    }
                }
                if (has_media && (!is_aside || connection.is_open)) course = new_course(ray.origin);
                if (!is_aside) first = false;
            } else {
                tell_miss(context);
                if (is_caught) {
                    show_background(context, path, camera);
                } else if (lit) {
                    leave_scene(context, path, ray, first);
                }
                first = false;
            }
        }
        if (!goes_on) {
            if (open.count == 0u) return path;
            open.count -= 1u;
            branch = open.branches[open.count];
            enter_branch(path, branch);
            ray = branch.ray;
            passes = branch.passes;
            first = branch.first;
            course = branch.course;
            stage = StageBranch;
        }
    }
}

WITH_CONTEXT inline Path trace_sample(IN(Context) context, uint x, uint y, uint64_t index) {
    const Path path = start_path(make_sampler(x, y, context.view.seed, index));
    const vec2 lens =
        (context.view.camera & CameraLens) != 0u ? sample_pair(path.numbers, LensPair) : vec2(0.5f);
    const vec2 u = sample_pair(path.numbers, CameraPair);
    const bool moves = (context.scene.features & FeatureCameraMotion) != 0u;
    const Ray ray = moves ? moving_camera_ray(context.view, context.time, x, y, u, lens)
                          : camera_ray(context.view, x, y, u, lens);
    FirstHit unknown;
    unknown.is_known = false;
    return trace_from(context, path, ray, unknown);
}

SHADING_END

#endif
