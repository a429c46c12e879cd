#pragma once

#include <cstddef>

#include "mediator/shading/records.h"

// C++ only: asserts that records have the scalar layout that shaders expect.
namespace tessera::shading {

static_assert(sizeof(FloatArray) == 8 && alignof(FloatArray) == 8);

static_assert(sizeof(Texture) == 48);
static_assert(offsetof(Texture, texels) == 0);
static_assert(offsetof(Texture, levels) == 8);
static_assert(offsetof(Texture, width) == 16);
static_assert(offsetof(Texture, height) == 20);
static_assert(offsetof(Texture, format) == 24);
static_assert(offsetof(Texture, wrap_s) == 28);
static_assert(offsetof(Texture, wrap_t) == 32);
static_assert(offsetof(Texture, texture_filter) == 36);
static_assert(offsetof(Texture, level_count) == 40);
static_assert(offsetof(Texture, depth) == 44);

static_assert(sizeof(TextureUse) == 32);
static_assert(offsetof(TextureUse, texture) == 0);
static_assert(offsetof(TextureUse, set) == 4);
static_assert(offsetof(TextureUse, row_u) == 8);
static_assert(offsetof(TextureUse, row_v) == 16);
static_assert(offsetof(TextureUse, offset) == 24);

static_assert(sizeof(Material) == 208);
static_assert(offsetof(Material, base_color) == 0);
static_assert(offsetof(Material, emission) == 16);
static_assert(offsetof(Material, metallic) == 28);
static_assert(offsetof(Material, roughness) == 32);
static_assert(offsetof(Material, normal_scale) == 36);
static_assert(offsetof(Material, index_of_refraction) == 40);
static_assert(offsetof(Material, alpha_cutoff) == 44);
static_assert(offsetof(Material, transmission) == 48);
static_assert(offsetof(Material, base_color_texture) == 52);
static_assert(offsetof(Material, metallic_roughness_texture) == 84);
static_assert(offsetof(Material, normal_texture) == 116);
static_assert(offsetof(Material, emission_texture) == 148);
static_assert(offsetof(Material, alpha_mode) == 180);
static_assert(offsetof(Material, double_sided) == 184);
static_assert(offsetof(Material, unlit) == 188);
static_assert(offsetof(Material, thin) == 192);
static_assert(offsetof(Material, extras) == 196);
static_assert(offsetof(Material, surface_shader) == 200);
static_assert(offsetof(Material, filters_color) == 204);

static_assert(sizeof(MaterialExtras) == 424);
static_assert(offsetof(MaterialExtras, specular_color) == 0);
static_assert(offsetof(MaterialExtras, specular) == 12);
static_assert(offsetof(MaterialExtras, sheen_color) == 16);
static_assert(offsetof(MaterialExtras, sheen_roughness) == 28);
static_assert(offsetof(MaterialExtras, coat) == 32);
static_assert(offsetof(MaterialExtras, coat_roughness) == 36);
static_assert(offsetof(MaterialExtras, coat_normal_scale) == 40);
static_assert(offsetof(MaterialExtras, anisotropy) == 44);
static_assert(offsetof(MaterialExtras, anisotropy_direction) == 48);
static_assert(offsetof(MaterialExtras, iridescence) == 56);
static_assert(offsetof(MaterialExtras, film_index) == 60);
static_assert(offsetof(MaterialExtras, film_thickness) == 64);
static_assert(offsetof(MaterialExtras, textures) == 72);
static_assert(offsetof(MaterialExtras, coat_normal_texture) == 360);
static_assert(offsetof(MaterialExtras, anisotropy_texture) == 392);

static_assert(sizeof(SurfaceShaderParams) == 340);
static_assert(offsetof(SurfaceShaderParams, specular) == 0);
static_assert(offsetof(SurfaceShaderParams, fresnel_blend) == 12);
static_assert(offsetof(SurfaceShaderParams, shininess) == 16);
static_assert(offsetof(SurfaceShaderParams, reflection) == 24);
static_assert(offsetof(SurfaceShaderParams, height_scale) == 36);
static_assert(offsetof(SurfaceShaderParams, transmission) == 40);
static_assert(offsetof(SurfaceShaderParams, normal_space) == 52);
static_assert(offsetof(SurfaceShaderParams, index_of_refraction) == 56);
static_assert(offsetof(SurfaceShaderParams, inverts_alpha) == 68);
static_assert(offsetof(SurfaceShaderParams, environment) == 72);
static_assert(offsetof(SurfaceShaderParams, tangent_set) == 84);
static_assert(offsetof(SurfaceShaderParams, normal_scale) == 88);
static_assert(offsetof(SurfaceShaderParams, binormal_set) == 100);
static_assert(offsetof(SurfaceShaderParams, normal_bias) == 104);
static_assert(offsetof(SurfaceShaderParams, textures) == 116);
static_assert(offsetof(SurfaceShaderParams, alpha_texture) == 244);
static_assert(offsetof(SurfaceShaderParams, height_texture) == 276);
static_assert(offsetof(SurfaceShaderParams, environment_texture) == 308);

static_assert(sizeof(MeshKey) == 16);
static_assert(offsetof(MeshKey, positions) == 0);
static_assert(offsetof(MeshKey, normals) == 8);

static_assert(sizeof(Mesh) == 96);
static_assert(offsetof(Mesh, positions) == 0);
static_assert(offsetof(Mesh, triangles) == 8);
static_assert(offsetof(Mesh, normals) == 16);
static_assert(offsetof(Mesh, tangents) == 24);
static_assert(offsetof(Mesh, colors) == 32);
static_assert(offsetof(Mesh, tex_coords) == 40);
static_assert(offsetof(Mesh, tex_coords_1) == 48);
static_assert(offsetof(Mesh, arrays) == 56);
static_assert(offsetof(Mesh, triangle_count) == 60);
static_assert(offsetof(Mesh, first_key) == 64);
static_assert(offsetof(Mesh, key_intervals) == 68);
static_assert(offsetof(Mesh, max_abs_position) == 72);
static_assert(offsetof(Mesh, key_fraction) == 76);
static_assert(offsetof(Mesh, next_positions) == 80);
static_assert(offsetof(Mesh, next_normals) == 88);

static_assert(sizeof(Affine3x4) == 48);
static_assert(offsetof(Affine3x4, linear) == 0);
static_assert(offsetof(Affine3x4, translation) == 36);

static_assert(sizeof(Motion) == 24);
static_assert(offsetof(Motion, first_key) == 0);
static_assert(offsetof(Motion, key_intervals) == 4);
static_assert(offsetof(Motion, max_abs_linear) == 8);
static_assert(offsetof(Motion, max_abs_translation) == 12);

static_assert(sizeof(Instance) == 120);
static_assert(offsetof(Instance, mesh) == 0);
static_assert(offsetof(Instance, material) == 4);
static_assert(offsetof(Instance, object) == 8);
static_assert(offsetof(Instance, light) == 12);
static_assert(offsetof(Instance, linear) == 16);
static_assert(offsetof(Instance, translation) == 52);
static_assert(offsetof(Instance, normals) == 64);
static_assert(offsetof(Instance, alpha_tested) == 100);
static_assert(offsetof(Instance, layers) == 104);
static_assert(offsetof(Instance, motion) == 108);
static_assert(offsetof(Instance, medium) == 112);
static_assert(offsetof(Instance, handedness) == 116);

static_assert(sizeof(Medium) == 176);
static_assert(offsetof(Medium, absorption) == 0);
static_assert(offsetof(Medium, priority) == 12);
static_assert(offsetof(Medium, scattering) == 16);
static_assert(offsetof(Medium, anisotropy) == 28);
static_assert(offsetof(Medium, emission) == 32);
static_assert(offsetof(Medium, index_matched) == 44);
static_assert(offsetof(Medium, low) == 48);
static_assert(offsetof(Medium, textured) == 60);
static_assert(offsetof(Medium, inverse_size) == 64);
static_assert(offsetof(Medium, index) == 76);
static_assert(offsetof(Medium, textures) == 80);

static_assert(sizeof(LightSource) == 108);
static_assert(offsetof(LightSource, kind) == 0);
static_assert(offsetof(LightSource, irradiance) == 4);
static_assert(offsetof(LightSource, intensity) == 8);
static_assert(offsetof(LightSource, position) == 20);
static_assert(offsetof(LightSource, direction) == 32);
static_assert(offsetof(LightSource, cos_inner) == 44);
static_assert(offsetof(LightSource, cos_outer) == 48);
static_assert(offsetof(LightSource, radius) == 52);
static_assert(offsetof(LightSource, one_minus_cos_half_angle) == 56);
static_assert(offsetof(LightSource, edge_u) == 60);
static_assert(offsetof(LightSource, edge_v) == 72);
static_assert(offsetof(LightSource, half_size) == 84);
static_assert(offsetof(LightSource, instance) == 92);
static_assert(offsetof(LightSource, first_emitter) == 96);
static_assert(offsetof(LightSource, layers) == 100);
static_assert(offsetof(LightSource, motion) == 104);

static_assert(sizeof(Emitter) == 16);
static_assert(offsetof(Emitter, light) == 0);
static_assert(offsetof(Emitter, triangle) == 4);
static_assert(offsetof(Emitter, node) == 8);
static_assert(offsetof(Emitter, inverse_root_area) == 12);

static_assert(sizeof(LightNode) == 48);
static_assert(offsetof(LightNode, center) == 0);
static_assert(offsetof(LightNode, radius) == 12);
static_assert(offsetof(LightNode, axis) == 16);
static_assert(offsetof(LightNode, cos_spread) == 28);
static_assert(offsetof(LightNode, cos_emission_angle) == 32);
static_assert(offsetof(LightNode, power) == 36);
static_assert(offsetof(LightNode, link) == 40);
static_assert(offsetof(LightNode, parent) == 44);

static_assert(sizeof(Environment) == 104);
static_assert(offsetof(Environment, map) == 0);
static_assert(offsetof(Environment, color) == 48);
static_assert(offsetof(Environment, strength) == 60);
static_assert(offsetof(Environment, rotation) == 64);
static_assert(offsetof(Environment, row_cdf) == 68);
static_assert(offsetof(Environment, column_cdf) == 72);
static_assert(offsetof(Environment, emits) == 76);
static_assert(offsetof(Environment, visible_color) == 80);
static_assert(offsetof(Environment, shows_color) == 96);
static_assert(offsetof(Environment, irradiance_unit) == 100);

static_assert(sizeof(Scene) == 264);
static_assert(offsetof(Scene, textures) == 0);
static_assert(offsetof(Scene, materials) == 8);
static_assert(offsetof(Scene, extras) == 16);
static_assert(offsetof(Scene, surface_shaders) == 24);
static_assert(offsetof(Scene, meshes) == 32);
static_assert(offsetof(Scene, instances) == 40);
static_assert(offsetof(Scene, lights) == 48);
static_assert(offsetof(Scene, emitters) == 56);
static_assert(offsetof(Scene, light_nodes) == 64);
static_assert(offsetof(Scene, cdfs) == 72);
static_assert(offsetof(Scene, srgb) == 80);
static_assert(offsetof(Scene, energy) == 88);
static_assert(offsetof(Scene, mesh_keys) == 96);
static_assert(offsetof(Scene, transform_keys) == 104);
static_assert(offsetof(Scene, motions) == 112);
static_assert(offsetof(Scene, media) == 120);
static_assert(offsetof(Scene, environment) == 128);
static_assert(offsetof(Scene, instance_count) == 232);
static_assert(offsetof(Scene, light_count) == 236);
static_assert(offsetof(Scene, tree_light_count) == 240);
static_assert(offsetof(Scene, unused) == 244);
static_assert(offsetof(Scene, tree_intensity) == 248);
static_assert(offsetof(Scene, environment_light) == 252);
static_assert(offsetof(Scene, features) == 256);
static_assert(offsetof(Scene, tree_scale) == 260);

static_assert(sizeof(View) == 200);
static_assert(offsetof(View, seed) == 0);
static_assert(offsetof(View, eye) == 8);
static_assert(offsetof(View, right) == 20);
static_assert(offsetof(View, up) == 32);
static_assert(offsetof(View, forward) == 44);
static_assert(offsetof(View, image_center) == 56);
static_assert(offsetof(View, step) == 64);
static_assert(offsetof(View, width) == 72);
static_assert(offsetof(View, height) == 76);
static_assert(offsetof(View, pixel_filter) == 80);
static_assert(offsetof(View, filter_radius) == 84);
static_assert(offsetof(View, max_scatter_events) == 88);
static_assert(offsetof(View, renderer) == 92);
static_assert(offsetof(View, path_class) == 96);
static_assert(offsetof(View, feature_rule) == 100);
static_assert(offsetof(View, channels) == 104);
static_assert(offsetof(View, recorded_quantities) == 108);
static_assert(offsetof(View, transparent_background) == 112);
static_assert(offsetof(View, strategy) == 116);
static_assert(offsetof(View, layers) == 120);
static_assert(offsetof(View, camera) == 124);
static_assert(offsetof(View, lens_radius) == 128);
static_assert(offsetof(View, focus_distance) == 132);
static_assert(offsetof(View, camera_keys) == 136);
static_assert(offsetof(View, camera_key_intervals) == 144);
static_assert(offsetof(View, containing_media) == 148);
static_assert(offsetof(View, max_specular_events) == 164);
static_assert(offsetof(View, clamp_indirect) == 168);
static_assert(offsetof(View, sky_cells_from) == 172);
static_assert(offsetof(View, sky_nodes) == 176);
static_assert(offsetof(View, sky_cells) == 184);
static_assert(offsetof(View, sky_cdfs) == 192);
static_assert(sizeof(SkyNode) == 12);
static_assert(sizeof(SkyCell) == 16);

}  // namespace tessera::shading
