#ifndef TESSERA_TESTS_SHADING_SCENE_CASES_H
#define TESSERA_TESTS_SHADING_SCENE_CASES_H

#include "tests/shading/cases.h"
#include "tests/shading/test_scene.h"

// Arguments for functions of a scene; wrappers return what functions change by reference.
SHADING_BEGIN

struct Case {
    Context context;
    Ray ray;
    Hit hit;
    Instance instance;
    Mesh mesh;
    Material material;
    MaterialExtras extras;
    SurfaceShaderParams shader;
    uvec3 corners;
    Triangle triangle;
    Texture map;
    TextureUse use;
    LightSource light;
    Emitter emitter;
    Receiver receiver;
    Instance lit;     // another instance, as the light
    Surface surface;  // computed on each side: bounds of functions that start from it are wider
    vec3 wo;          // in its frame
    Path path;
    PathClassInfo class_info;
    Branch branch;
};

inline Path path_in(IN(Inputs) x) {
    Path path = start_path(Sampler(x.a, x.d));
    path.vertex = x.c % 6u;
    path.walls = x.d % (path.vertex + 1u);
    path.throughput = x.color;
    path.probability = x.transmission;
    path.bsdf_pdf = x.c % 3u == 0u ? 0.0f : x.pdf;
    path.last_position = x.wo;
    path.last_normal = x.n;
    path.last_sky_cell = x.b % 3u == 2u ? NoSkyCell : x.b % 3u;
    path.cone = RayCone(x.metallic, x.transmission);
    path.class_info = PathClassInfo(x.c % 4u, x.c % 5u == 0u, x.light);
    path.found.low = x.light;
    path.found.high = x.color;
    path.found.diffuse = x.color * x.metallic;
    path.found.connections = x.metallic;
    path.found.albedo = x.light;
    path.found.normal = x.n;
    path.found.headlight = x.color;
    path.found.depth = x.c % 5u == 0u ? infinity() : x.pdf;
    path.found.object = x.d;
    path.found.alpha = x.metallic;
    path.rays = x.c;
    return path;
}

inline Case make_case(IN(TestScene) test_scene, IN(Inputs) x) {
    Case made;
    made.context.scene = test_scene.scenes.items[x.c % 8u == 0u ? 1u : 0u];
    // Motion has its own functions: the others are compiled without it.
    made.context.scene.features = made.context.scene.features & ~(FeatureMotion | FeatureCameraMotion);
    made.context.view = test_scene.views.items[x.d % ViewCount];
    made.context.time = 0.0f;
    made.ray = Ray(x.wi, x.n);
    made.instance = made.context.scene.instances.items[x.instance];
    made.mesh = made.context.scene.meshes.items[made.instance.mesh];
    made.material = made.context.scene.materials.items[made.instance.material];
    made.extras = made.context.scene.extras.items[x.d % 4u];
    made.shader = made.context.scene.surface_shaders.items[x.d % SurfaceShaderCount];
    made.hit = Hit(x.instance, x.c % made.mesh.triangle_count, x.weights, x.pdf);
    made.corners = made.mesh.triangles.items[made.hit.triangle];
    made.triangle = triangle_of(made.mesh, made.corners);
    made.map = made.context.scene.textures.items[x.d % TextureCount];
    made.use = made.material.base_color_texture;
    if (made.use.texture < 0) made.use.texture = 0;
    made.lit = made.context.scene.instances.items[x.instance ^ 1u];
    made.light = made.context.scene.lights.items[x.d % LightCount];
    made.emitter = made.context.scene.emitters.items[x.d % TriangleEmitters];
    made.receiver =
        Receiver(x.wo, x.c % 3u == 0u ? vec3(0.0f) : x.n, x.c % 5u == 0u ? 4.0f * x.wi : vec3(0.0f),
                 x.d % 3u == 2u ? NoSkyCell : x.d % 3u);
    made.surface = make_surface(made.context.scene, made.hit, x.n, x.c % 2u == 0u ? 0.0f : x.metallic,
                                no_media(), made.context.time);
    made.wo = to_local(made.surface, -x.n);
    made.path = path_in(x);
    made.class_info = PathClassInfo(x.d % 4u, x.d % 5u == 0u, x.light);
    made.branch = Branch(made.ray, RayCone(x.metallic, x.transmission), x.color, x.transmission, x.c % 64u,
                         x.c % (MaxSpecularDepth + 1u), made.path.chain, no_media(),
                         new_traversal(made.ray.origin), false, x.c % 3u == 0u);
    return made;
}

// The scene with everything moving, by its first motion; and a mesh that deforms from the first mesh to the
// fourth.
inline Scene moving_scene(IN(Case) c) {
    Scene scene = c.context.scene;
    scene.features = scene.features | FeatureMotion;
    return scene;
}
inline Mesh deforming_mesh(IN(Case) c, float time) {
    Mesh mesh = c.mesh;
    mesh.arrays = mesh.arrays | MeshDeforms;
    mesh.first_key = 0u;
    mesh.key_intervals = 3u;
    mesh.max_abs_position = 2.0f;
    return mesh_at(moving_scene(c), mesh, time);
}
inline Affine3x4 moved_transform(IN(Case) c, float time) {
    const Instance moved = instance_at(moving_scene(c), c.instance, time);
    return Affine3x4(moved.linear, moved.translation);
}
// Offset from 0, where cancelling sums are as small as their rounding error.
inline Affine3x4 far_transform(IN(Affine3x4) p) {
    return Affine3x4(mat3(4.0f + p.linear[0], 4.0f + p.linear[1], 4.0f + p.linear[2]), 4.0f + p.translation);
}
inline Triangle far_triangle(IN(Triangle) t) {
    return Triangle(4.0f + t.p, 4.0f + t.q, 4.0f + t.r);
}
inline mat3 moved_light(IN(Case) c, float time) {
    const LightSource moved = light_at(moving_scene(c), c.light, time);
    return mat3(moved.position, moved.direction, moved.edge_u);
}
// The area as a fraction of the triangle's extent squared, since the area of a thin triangle is as small as
// its rounding error.
inline float changing_area(IN(Case) c) {
    Emitter emitter = c.emitter;
    emitter.inverse_root_area = 0.0f;
    const vec3 q = c.instance.linear * (c.triangle.q - c.triangle.p);
    const vec3 r = c.instance.linear * (c.triangle.r - c.triangle.p);
    const float ratio = inverse_root_area_of(moving_scene(c), emitter, c.instance, c.triangle) *
                        extent_of(max(abs(q), abs(r)));
    return 1.0f + 1.0f / (ratio * ratio);
}
// From straight above a triangle of the first mesh light.
inline float hit_pdf_at(IN(Case) c, float time) {
    Emitter emitter = c.emitter;
    emitter.inverse_root_area = 0.0f;
    Surface hit = c.surface;
    hit.time = time;
    hit.triangle = 0u;
    for (uint i = 0u; i < LightCount; ++i) {
        if (c.context.scene.lights.items[i].kind != LightMesh) continue;
        hit.light = int(i);
        return hit_triangle_pdf(moving_scene(c), emitter, hit, hit.position + 1000.0f * hit.geometric_normal);
    }
    return 0.0f;
}
// Neither thin nor seen from its edge.
inline TriangleView seen_triangle(IN(Case) c, IN(Inputs) x) {
    Instance instance = c.instance;
    instance.linear = mat3(1.0f);
    instance.translation = x.n;
    const mat3 frame = frame_around(x.n);
    return view_triangle(instance, Triangle(vec3(0.0f), 0.5f * frame[0], 0.5f * frame[1]), 1.0f, 0.3f * x.wi);
}
inline View moving_view(IN(Case) c) {
    View view = c.context.view;
    view.camera_keys = c.context.scene.transform_keys;
    view.camera_key_intervals = 3u;
    return view;
}
inline Ray moved_eye(IN(Case) c, float time) {
    View moved = view_at(FeatureCameraMotion, moving_view(c), time);
    return Ray(moved.eye, moved.forward);
}

// The clip-space position of a point in a cell of 512 pixels at the picture's corner.
inline PointWithError clip_of(IN(Case) c, vec3 from_eye) {
    const RasterCell cell = RasterCell(vec2(0.25f, -0.125f), vec2(-0.5f, 0.75f), 0u, 0u, 512u, 0u);
    const vec4 clip = raster_clip(c.context.view, cell, from_eye);
    return PointWithError(vec3(clip.x, clip.y, clip.w), vec3(clip.z));
}
inline ChosenEmitter given_emitter(IN(Case) c, IN(Inputs) x) {
    if (c.context.scene.tree_light_count == 0u || x.a % 3u != 0u) return no_emitter();
    return ChosenEmitter(x.b % TriangleEmitters, 0.3f);
}
inline LightSample on_lit_mesh(IN(Case) c, vec2 u) {
    return sample_mesh_light(c.context.scene, c.emitter, 0.5f, c.lit,
                             c.context.scene.meshes.items[c.lit.mesh],
                             c.context.scene.materials.items[c.lit.material], c.surface, u);
}
// The end of its shadow ray relative to the surface, which may be far from all lights.
inline LightSample on_sphere(IN(Case) c, vec2 u) {
    LightSample found = sample_sphere_light(c.light, c.surface, 0.5f, u);
    found.target -= c.surface.position;
    return found;
}
// The area that a footprint is relative to, and the product of edges that its rounding error is relative to. Next to
// areas whose squares a device does not flush.
inline float covered_area(IN(Case) c, float cosine, float width) {
    const float footprint = triangle_footprint(c.context.scene, c.instance, c.triangle, cosine, width);
    const float first = vector_length(c.instance.linear * (c.triangle.q - c.triangle.p));
    const float second = vector_length(c.instance.linear * (c.triangle.r - c.triangle.p));
    return 1e-16f + first * second * cosine + (footprint > 0.0f ? width * width / footprint : 0.0f);
}
// Up to four, with repetitions.
inline ThinWalls met_walls(IN(Case) c, uint bits) {
    ThinWalls walls = bits % 5u == 0u ? unknown_thin_walls() : no_thin_walls();
    for (uint i = 0u; i < bits % 7u; ++i) {
        Hit hit = c.hit;
        hit.triangle = (bits >> i) % 4u;
        hit.distance = float(hit.triangle < 2u ? 0u : hit.triangle);
        meet_thin_wall(walls, hit);
    }
    return walls;
}
inline ThinWalls two_walls(IN(Case) c) {
    ThinWalls walls = no_thin_walls();
    walls.count = 2u;
    walls.first = c.hit;
    walls.second = c.hit;
    walls.second.barycentric = vec2(c.hit.barycentric.y, c.hit.barycentric.x);
    walls.second.distance = c.path.rays % 2u == 0u ? 0.0f : infinity();
    return walls;
}
inline vec3 passed_walls(IN(Case) c, vec3 direction, vec3 light) {
    vec3 passed = light, intensity = vec3(1.0f);
    pass_thin_walls(c.context, two_walls(c), direction, passed, intensity);
    return passed * (1.0f + intensity);
}
inline Surface with_scattering(IN(Case) c) {
    Surface surface = c.surface;
    set_scattering(surface, c.context.scene, c.instance, c.mesh, c.material, c.corners, c.hit.barycentric,
                   c.surface.geometric_normal, c.ray.direction, no_media());
    return surface;
}
inline Surface coated(IN(Case) c, IN(Inputs) x) {
    Surface surface = c.surface;
    add_smooth_coat(surface, material_sample_of(x), x.c % 2u == 0u, x.n);
    return surface;
}
inline PathSample with_object(IN(Case) c, uint object, float depth) {
    PathSample found = c.path.found;
    record_object_id(found, object, depth);
    return found;
}
// The area of thinner triangles is dominated by the rounding error of the products of their edges.
inline bool has_area(IN(EdgesInWorld) edges) {
    return dot(edges.across, edges.across) > 1e-4f * dot(edges.p, edges.p) * dot(edges.q, edges.q);
}
inline EdgesInWorld edges_of(IN(Case) c) {
    const EdgesInWorld edges = edges_in_world(c.instance, c.triangle);
    if (has_area(edges)) return edges;
    return EdgesInWorld(vec3(1.0f, 0.0f, 0.0f), vec3(0.0f, 1.0f, 0.0f), vec3(0.0f, 0.0f, 1.0f), 1.0f);
}
inline vec3 bumped_normal(IN(Case) c, IN(Inputs) x) {
    if (!has_area(edges_in_world(c.instance, c.triangle))) return x.n;
    return shader_normal(c.context.scene, c.instance, c.shader, c.use, c.triangle, c.mesh, c.corners,
                         x.weights, x.n);
}
// Relative to the size of its terms.
inline vec3 gradient_of(IN(Case) c, vec2 steps) {
    const EdgesInWorld edges = edges_of(c);
    const float area = vector_length(edges.across);
    return area > 0.0f ? surface_gradient(edges, steps.x, steps.y) * (area / edges.scale) : vec3(0.0f);
}
inline SurfaceShaderLobes shader_here(IN(Case) c, IN(Inputs) x) {
    return shader_lobes_at(c.context.scene, x.d % SurfaceShaderCount, c.mesh, c.corners, x.weights, x.color,
                           x.c % 2u == 0u, x.wo.z);
}
// On a surface without anything else.
inline Specular shader_specular(IN(Case) c, IN(Inputs) x) {
    Surface surface;
    surface.geometric_normal = x.n;
    surface.frame = frame_around(unit_vector(x.n + 0.3f * x.wo));
    surface.scatters = true;
    surface.rough_fraction = 1.0f;
    surface.specular = no_specular();
    set_shader_specular(surface, c.context.scene, shader_of(x), arriving_at(x));
    return surface.specular;
}
inline Path with_own_environment(IN(Case) c) {
    Path path = c.path;
    path.chain.environment = c.context.scene.instance_count > 0u ? 0 : -1;
    add_shader_environment(c.context, path, c.ray);
    return path;
}
inline PathSample with_light(IN(Case) c, vec3 light) {
    PathSample found = c.path.found;
    add_light(found, c.context.view, light, c.class_info);
    return found;
}
inline PathSample with_connection(IN(Case) c, vec3 light) {
    PathSample found = c.path.found;
    connect_light(found, c.context.view, light);
    return found;
}
inline Path with_sky(IN(Case) c) {
    Path path = c.path;
    add_sky(c.context, path, c.ray);
    return path;
}
inline Path with_emission(IN(Case) c) {
    Path path = c.path;
    add_emission(c.context, path, c.ray, c.surface);
    return path;
}
inline Path with_shapes(IN(Case) c, float far) {
    Path path = c.path;
    add_area_lights(c.context, path, c.ray, 0.0f, far);
    return path;
}
inline Path with_shape(IN(Case) c, float far) {
    Path path = c.path;
    add_area_light(c.context, path, c.ray, 0.0f, far, c.emitter, c.light);
    return path;
}
inline Path out_of_scene(IN(Case) c, bool is_first) {
    Path path = c.path;
    leave_scene(c.context, path, c.ray, is_first);
    return path;
}
inline Path with_sun_disks(IN(Case) c) {
    Path path = c.path;
    add_sun_disks(c.context, path, c.ray);
    return path;
}
inline Receiver surface_receiver(IN(Case) c) {
    return receiver_at(c.context.view, c.path.numbers.index, c.surface);
}
inline Path with_lights(IN(Case) c) {
    Path path = c.path;
    Connection connection = no_connection();
    add_lights(c.context, path, c.surface, surface_receiver(c), c.wo, no_equiangular_sample(), 0.5f,
               connection);
    return path;
}

// A path, whether it continues, and its next ray.
struct Step {
    Path path;
    Lobe lobe;
    Ray ray;
    bool goes_on;
};

inline Path without_catch(IN(Case) c) {
    Path path = c.path;
    show_background(c.context, path, c.ray);
    return path;
}
inline Step first_step(IN(Case) c) {
    return Step(c.path, rough_lobe(c.path), c.ray, false);
}
inline Step caught_step(IN(Case) c) {
    Step step = first_step(c);
    step.ray = leave_catcher(step.path, c.surface);
    return step;
}
inline Step passed_catcher(IN(Case) c) {
    Step step = first_step(c);
    step.goes_on = pass_catcher(c.context, step.path, step.ray, c.surface);
    return step;
}
inline Step chosen_lobe(IN(Case) c) {
    Step step = first_step(c);
    step.lobe = choose_lobe(step.path, c.surface, step.lobe);
    return step;
}
inline Step scattered(IN(Case) c) {
    Step step = first_step(c);
    step.goes_on = scatter(c.context.scene.energy, c.context.view, step.path, c.surface, surface_receiver(c),
                           c.wo, step.lobe, step.ray.direction);
    return step;
}
inline Step scattered_specular(IN(Case) c, uint kind, bool is_straight) {
    Step step = first_step(c);
    step.lobe.kind = kind;
    step.ray.direction = scatter_specular(c.context, step.path, c.surface, step.lobe, is_straight);
    return step;
}
inline Step survivor(IN(Case) c, float choice) {
    Step step = first_step(c);
    step.goes_on = survives(step.path, choice);
    return step;
}

inline BranchStack with_children(IN(Case) c) {
    BranchStack stack;
    stack.branches[0] = c.branch;
    stack.branches[1] = c.branch;
    stack.count = 0u;
    push_children(stack, c.context.scene, c.branch, c.branch.cone, no_media(), c.surface,
                  channel_of(c.path.numbers));
    return stack;
}
inline Path in_branch(IN(Case) c) {
    Path path = c.path;
    path_from_branch(path, c.branch);
    return path;
}
inline Sink empty_sink() {
    Sink sink;
    sink.sums = vec2(0.0f);
    sink.infinite = 0u;
    sink.count = 0u;
    return sink;
}
inline Sink with_number(IN(Case) c, float value) {
    Sink sink = empty_sink();
    put_number(sink, c.context.view, ChannelDepth, value);
    return sink;
}
inline Sink with_vector(IN(Case) c, vec3 value) {
    Sink sink = empty_sink();
    put_vector(sink, c.context.view, ChannelNormal, value);
    return sink;
}
inline Sink with_values(IN(Case) c) {
    Sink sink = empty_sink();
    put_sample_values(sink, c.context.view, c.path.found);
    return sink;
}

SHADING_END

#endif
