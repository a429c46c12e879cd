#ifndef TESSERA_MEDIATOR_SHADING_RECORDS_H
#define TESSERA_MEDIATOR_SHADING_RECORDS_H

#include "mediator/shading/language.h"

// The scene records that renderers read: the same bytes in C++ and GLSL (scalar layout, asserted in
// layout.h). Positions are relative to the render origin. Tables are ordered by object id, so they depend on
// the scene's content alone. Arrays are referred to by address: a host pointer on the CPU, a device address
// on a GPU. A count or a flag in the record says whether an array is present.
RECORDS_BEGIN

ARRAY_OF(float, FloatArray, 4);
ARRAY_OF(uint, UintArray, 4);
ARRAY_OF(vec2, Vec2Array, 4);
ARRAY_OF(vec3, Vec3Array, 4);
ARRAY_OF(vec4, Vec4Array, 4);
ARRAY_OF(uvec3, UVec3Array, 4);

// Values as in scene/objects.h.
inline constexpr uint TexelRgba8 = 0u, TexelRgba8Srgb = 1u, TexelRgbFloat = 2u;
inline constexpr uint TexelRgba8Signed = 3u;  // signed bytes, -127 to 127; stored as Rgba8
inline constexpr uint NormalTangent = 0u, NormalObject = 1u;
inline constexpr uint WrapRepeat = 0u, WrapMirror = 1u, WrapClamp = 2u;
inline constexpr uint TextureLinear = 0u, TextureNearest = 1u;
inline constexpr uint AlphaOpaque = 0u, AlphaMask = 1u, AlphaBlend = 2u;

// Rows are stored from the top, tightly packed. Rgba8: red in the lowest byte; RgbFloat: three floats per
// texel. `levels` holds the mip levels one after the other; each has half the size of the one before (rounded
// down, at least 1).
struct Texture {
    UintArray texels;
    UintArray levels;
    uint width;
    uint height;
    uint format;
    uint wrap_s;
    uint wrap_t;
    uint texture_filter;
    uint level_count;  // mip levels, without the full-size image
    uint depth;        // slices, one after the other; only media use more than the first
};

// A use of a texture, with its transform: u' = dot(row_u, uv) + offset.x, and v' likewise.
struct TextureUse {
    int texture;  // index; -1 = none
    uint set;     // of texture coordinates: 0 or 1
    vec2 row_u;
    vec2 row_v;
    vec2 offset;
};

// No refraction and no interior medium; light may go straight through, as through a pane of clear glass.
inline constexpr uint ThinWalled = 1u, ThinClear = 2u;

// As scene::Material; every value is factor x texture.
struct Material {
    vec4 base_color;
    vec3 emission;
    float metallic;
    float roughness;
    float normal_scale;
    float index_of_refraction;
    float alpha_cutoff;
    float transmission;
    TextureUse base_color_texture;
    TextureUse metallic_roughness_texture;
    TextureUse normal_texture;
    TextureUse emission_texture;
    uint alpha_mode;
    uint double_sided;  // 1 or 0, as all boolean fields
    uint unlit;
    uint thin;           // bits: ThinWalled, ThinClear
    int extras;          // index; -1 = none
    int surface_shader;  // index; -1 = none
    uint filters_color;  // the colour is the only texture, and is filtered over the footprint (ray_cones.h)
};

// Rare parameters, kept out of line. Their textures are looked up in a loop: unrolled lookups would dominate
// code size.
inline constexpr uint ExtrasTransmission = 0u, ExtrasSpecular = 1u, ExtrasSpecularColor = 2u, ExtrasCoat = 3u,
                      ExtrasCoatRoughness = 4u, ExtrasSheenColor = 5u, ExtrasSheenRoughness = 6u,
                      ExtrasIridescence = 7u, ExtrasThickness = 8u, ExtrasTextureCount = 9u;
struct MaterialExtras {
    vec3 specular_color;
    float specular;
    vec3 sheen_color;
    float sheen_roughness;
    float coat;
    float coat_roughness;
    float coat_normal_scale;
    float anisotropy;
    vec2 anisotropy_direction;  // cosine and sine of the angle to the tangent
    float iridescence;
    float film_index;
    vec2 film_thickness;  // minimum and maximum, in nanometres
    TextureUse textures[ExtrasTextureCount];
    TextureUse coat_normal_texture;
    TextureUse anisotropy_texture;
};

inline constexpr uint SurfaceShaderSpecular = 0u, SurfaceShaderShininess = 1u, SurfaceShaderReflection = 2u,
                      SurfaceShaderTransmission = 3u, SurfaceShaderTextureCount = 4u;
// Parameters that only CommonSurfaceShader has (Schwenk 5.A.3). Its diffuse part, emission and normal map are
// in Material.
struct SurfaceShaderParams {
    vec3 specular;
    float fresnel_blend;
    vec2 shininess;
    vec3 reflection;
    float height_scale;
    vec3 transmission;
    uint normal_space;
    vec3 index_of_refraction;  // inside / outside, per colour channel
    uint inverts_alpha;
    vec3 environment;
    int tangent_set;  // texture coordinate set whose u direction is the tangent; -1: the mesh's tangents
    vec3 normal_scale;
    int binormal_set;
    vec3 normal_bias;
    TextureUse textures[SurfaceShaderTextureCount];
    TextureUse alpha_texture;
    TextureUse height_texture;
    TextureUse environment_texture;
};

// Which arrays a mesh has in addition to positions and triangles.
inline constexpr uint MeshNormals = 1u, MeshTangents = 2u, MeshColors = 4u, MeshTexCoords = 8u,
                      MeshTexCoords1 = 16u, MeshDeforms = 32u;

// Vertices of a deforming mesh at one motion key; normals if the mesh has any.
struct MeshKey {
    Vec3Array positions;
    Vec3Array normals;
};

struct Mesh {
    Vec3Array positions;
    UVec3Array triangles;
    Vec3Array normals;
    Vec4Array tangents;  // w = handedness
    Vec4Array colors;
    Vec2Array tex_coords;
    Vec2Array tex_coords_1;
    uint arrays;
    uint triangle_count;
    uint first_key;          // of MeshDeforms: index of its first motion key
    uint key_intervals;      // motion keys - 1
    float max_abs_position;  // largest absolute coordinate at any key
    float key_fraction;      // of a mesh at a time (motion.h): from `positions`, `normals` to
    Vec3Array next_positions;
    Vec3Array next_normals;
};

inline constexpr uint AllLayers = 0xffffffffu;
inline constexpr int ShadowCatcher = -2;

// A transform from object to world space, at one motion key.
struct Affine3x4 {
    mat3 linear;
    vec3 translation;
};

// A range of motion keys at even times over the shutter; transforms are interpolated linearly between them.
struct Motion {
    uint first_key;
    uint key_intervals;        // motion keys - 1, at least 1
    float max_abs_linear;      // bound of any element of `linear` at any key
    vec3 max_abs_translation;  // bound of the translation at any key
};

struct Instance {
    uint mesh;      // index
    uint material;  // index
    uint object;    // id of the geometry
    int light;      // index, if it emits and can be hit; else -1, or ShadowCatcher
    mat3 linear;    // world from object
    vec3 translation;
    mat3 normals;       // cofactors of `linear` times a power of two: they turn normals, to their own side
    uint alpha_tested;  // hits need a test: stops_at, and is_thin_wall on the way to a light
    uint layers;        // not there for views that see none of them
    int motion;         // index; -1 = static
    int medium;         // index; -1 = no interior medium
    float handedness;   // of `linear`: 1, or -1 where it mirrors
};

inline constexpr uint MediumAbsorption = 0u, MediumScattering = 1u, MediumEmission = 2u,
                      MediumTextureCount = 3u;
// The participating medium inside a closed mesh (Schwenk 5.B.3); coefficients are per metre in world space.
// Its textures fill the mesh's object-space bounding box: u along x, v along -y, slices along z.
struct Medium {
    vec3 absorption;
    int priority;  // where media overlap, the highest one applies; among equals the one entered last
    vec3 scattering;
    float anisotropy;    // Henyey and Greenstein's g
    vec3 emission;       // radiance
    uint index_matched;  // the boundary has no surface: rays pass straight through
    vec3 low;            // of the bounding box
    uint textured;       // whether it has any texture
    vec3 inverse_size;
    float index;  // of refraction; 0: infinite; -1: that of the surrounding medium
    TextureUse textures[MediumTextureCount];
};
// Media that a point can be in at once; those of the lowest priority beyond are dropped.
inline constexpr uint MaxNestedMedia = 4u;

inline constexpr uint LightPoint = 0u, LightSpot = 1u, LightDirectional = 2u, LightMesh = 3u,
                      LightEnvironment = 4u, LightSphere = 5u, LightQuad = 6u;

struct LightSource {
    uint kind;
    float irradiance;  // of an infinite light, on a surface that faces it, as a weight (light_choice.h)
    vec3 intensity;    // of lights with a size (sphere, quad, sun disk): radiance
    vec3 position;
    vec3 direction;  // of emission
    float cos_inner;
    float cos_outer;
    float radius;                    // of a sphere
    float one_minus_cos_half_angle;  // of a directional light's angular diameter; 0 = delta
    vec3 edge_u;                     // of a quad: directions of its edges, of unit length
    vec3 edge_v;
    vec2 half_size;      // along them
    uint instance;       // of a mesh light
    uint first_emitter;  // of a mesh light: that of its first triangle; else its own
    uint layers;         // as of an instance
    int motion;          // as of an instance; not of a mesh light
};

// A leaf of the light tree: a triangle of a mesh light, or a punctual, sphere or quad light.
struct Emitter {
    uint light;               // index
    uint triangle;            // of the mesh
    uint node;                // its leaf in the light tree; NoLightNode if it emits nothing
    float inverse_root_area;  // 1 / square root of its area in the world, which may leave the range of
                              // floats; 0: its area changes, and is computed at the sample's time (motion.h)
};
inline constexpr uint NoLightNode = 0xffffffffu;

// A node of the light tree: bounds of all its emitters (Conty Estevez and Kulla 2018). Node 0 is the root;
// children are contiguous.
struct LightNode {
    vec3 center;  // of their bounding sphere
    float radius;
    vec3 axis;                 // of the cone that bounds the emitters' normals
    float cos_spread;          // of its half angle; -1: all directions
    float cos_emission_angle;  // of the angle to which each shines around its own direction
    float power;               // fraction of the tree's; more than 0
    uint link;                 // the first child, or the emitter of a leaf; and the bits below
    uint parent;
};
inline constexpr uint LightLeaf = 0x80000000u, LightTwoSided = 0x40000000u, LightIndexBits = 0x03ffffffu;
inline constexpr uint LightContainsArea = 0x08000000u;  // the subtree has sphere or quad lights
inline constexpr uint LightByPower =
    0x04000000u;  // children are triangles of one flat emitter: choose by power alone
inline constexpr uint LightCountShift = 28u, MaxLightChildren = 4u;  // two bits: children - 1

// The environment light: color + strength x map. Width 0: no map.
struct Environment {
    Texture map;
    vec3 color;
    float strength;
    float rotation;
    uint row_cdf;     // index of the rows' cumulative distribution
    uint column_cdf;  // index of the cumulative distributions within each row
    uint emits;
    vec4 visible_color;     // background and alpha for camera rays that miss
    uint shows_color;       // whether they see it instead of the environment light
    float irradiance_unit;  // LightSource's irradiance of a sky of luminance 1
};

// Features that occur in a scene; kernels can be compiled without the others.
inline constexpr uint FeatureTextures = 1u, FeatureNormalMaps = 2u, FeatureAlpha = 4u, FeatureSpecular = 8u,
                      FeaturePunctualLights = 16u, FeatureMeshLights = 32u, FeatureEnvironment = 64u,
                      FeatureEnvironmentMap = 128u;
// Rare lobes, and whether any material has extras.
inline constexpr uint FeatureCoat = 4096u, FeatureSheen = 8192u, FeatureRoughGlass = 16384u,
                      FeatureExtras = 32768u, FeatureIridescence = 0x8000000u;
// Thin walls that light may go straight through (ThinClear).
inline constexpr uint FeatureThinGlass = 512u;
// Of a scene and view: some objects are in none of the view's layers.
inline constexpr uint FeatureLayers = 256u;
// More than one emitter; sphere and quad lights; directional lights with an angular diameter (sun disks).
inline constexpr uint FeatureLightTree = 0x10000u, FeatureAreaLights = 0x20000u, FeatureSunDisks = 0x40000u;
inline constexpr uint FeatureShadowCatcher = 0x80000u;
// Something moves while the shutter is open; of a view: its camera moves.
inline constexpr uint FeatureMotion = 0x2000000u, FeatureCameraMotion = 0x4000000u;
// CommonSurfaceShader.
inline constexpr uint FeatureSurfaceShader = 0x800000u;
// Media that affect light; some are index-matched (no surface); some scatter; some are textured.
inline constexpr uint FeatureMedia = 0x1000000u, FeatureIndexMatchedMedia = 0x10000000u,
                      FeatureScattering = 0x20000000u, FeatureMediaTextures = 0x40000000u;
// Some glass objects may be nested in others.
inline constexpr uint FeatureNestedGlass = 0x80000000u;

// A node of a k-d tree over places (sky_cells.h): the first of two children, or a cell.
struct SkyNode {
    float split;
    uint axis;
    uint child;
};

// Light samples of the sky in a region (sky_cells.h).
struct SkyCell {
    uint cdf;           // of its tiles
    float tile_chance;  // probability of sampling by tiles; else by the map
    float irradiance;   // that arrives, in the unit of LightSource
    float suns;         // share of the light of directional lights that arrives, in (0, 1)
};

ARRAY_OF(SkyNode, SkyNodeArray, 4);
ARRAY_OF(SkyCell, SkyCellArray, 4);
ARRAY_OF(Texture, TextureArray, 8);
ARRAY_OF(Material, MaterialArray, 4);
ARRAY_OF(MaterialExtras, MaterialExtrasArray, 4);
ARRAY_OF(SurfaceShaderParams, SurfaceShaderParamsArray, 4);
ARRAY_OF(Mesh, MeshArray, 8);
ARRAY_OF(MeshKey, MeshKeyArray, 8);
ARRAY_OF(Affine3x4, Affine3x4Array, 4);
ARRAY_OF(Motion, MotionArray, 4);
ARRAY_OF(Instance, InstanceArray, 4);
ARRAY_OF(Medium, MediumArray, 4);
ARRAY_OF(LightSource, LightSourceArray, 4);
ARRAY_OF(Emitter, EmitterArray, 4);
ARRAY_OF(LightNode, LightNodeArray, 4);

struct Scene {
    TextureArray textures;
    MaterialArray materials;
    MaterialExtrasArray extras;
    SurfaceShaderParamsArray surface_shaders;
    MeshArray meshes;
    InstanceArray instances;
    LightSourceArray lights;  // those in the tree, then the infinite lights
    EmitterArray emitters;
    LightNodeArray light_nodes;
    FloatArray cdfs;    // all cumulative distributions; records hold the index of their first element
    FloatArray srgb;    // linear value of each byte (IEC 61966-2-1)
    FloatArray energy;  // directional albedos of lobes (energy.h)
    MeshKeyArray mesh_keys;
    Affine3x4Array transform_keys;
    MotionArray motions;
    MediumArray media;
    Environment environment;
    uint instance_count;
    uint light_count;
    uint tree_light_count;  // of them in the tree
    uint unused;            // keeps the size a multiple of an address's
    float tree_intensity;   // times expected_light() of its nodes: their irradiance, as of an infinite light
    int environment_light;  // index of the environment's light source, or -1
    FeatureBits features;
    float tree_scale;  // a power of two that scales the light tree's extent to about 1
};

// Values as in view/view.h.
inline constexpr uint FilterBox = 0u, FilterGaussian = 1u, FilterBlackmanHarris = 2u;
inline constexpr uint RendererPathTracing = 0u, RendererWhitted = 1u, RendererRaster = 2u,
                      RendererObjectId = 3u;
inline constexpr uint ClassIndirect = 0u, ClassCaustics = 1u, ClassDiffuse = 2u, ClassAll = 3u,
                      ClassNone = 4u;
inline constexpr uint RuleDemodulated = 0u, RuleConnections = 1u;
// Light sampling strategies; all have the same expectation. Only tests use others than StrategyBoth.
inline constexpr uint StrategyBoth = 0u, StrategyLightsOnly = 1u, StrategyBsdfOnly = 2u;
// Sampling of light in media by only one of the two techniques (equiangular.h).
inline constexpr uint StrategyFlightOnly = 3u, StrategyEquiangularOnly = 4u;
inline constexpr uint CameraPinhole = 0u, CameraOrthographic = 1u, CameraLens = 2u, CameraGaussian = 4u;
// Quantities that a sample records in addition to its radiance.
inline constexpr uint RecordsDiffuse = 1u, RecordsConnections = 2u, RecordsHeadlight = 4u;
inline constexpr uint UnlimitedScatterEvents = 0xffffffffu;
inline constexpr uint NoSkyCells = 0xffffffffu, NoSkyCell = 0xffffffffu;

struct View {
    uint64_t seed;
    vec3 eye;
    vec3 right;
    vec3 up;
    vec3 forward;
    vec2 image_center;  // in the image plane at distance 1 from the eye; orthographic: in metres
    vec2 step;          // pixel spacing there; y goes down the picture
    uint width;
    uint height;
    uint pixel_filter;
    float filter_radius;
    uint max_scatter_events;
    uint renderer;
    uint path_class;
    uint feature_rule;
    uint channels;  // bits as in frame/channels.h
    uint recorded_quantities;
    uint transparent_background;
    uint strategy;
    uint layers;  // visible to the view
    uint camera;  // bits; CameraPinhole = plain perspective
    float lens_radius;
    float focus_distance;
    Affine3x4Array camera_keys;  // motion keys of a moving camera, the first one at shutter open
    uint camera_key_intervals;
    uvec4 containing_media;    // instances of the media that the eye is in (containing_media.h)
    uint max_specular_events;  // perfect reflections and refractions of a path
    float clamp_indirect;      // most of a component that indirect light adds at once; 0 = no limit
    uint sky_cells_from;       // first sample that uses the sky cells; NoSkyCells: none does
    SkyNodeArray sky_nodes;
    SkyCellArray sky_cells;
    FloatArray sky_cdfs;
};

RECORDS_END

#ifdef __cplusplus

SHADING_BEGIN

// Features that most scenes use.
inline constexpr uint CommonFeatures =
    FeatureTextures | FeatureSpecular | FeatureMeshLights | FeatureEnvironment | FeatureLightTree;

// Features that a kernel was not compiled for are constant 0, so the compiler removes their code. Rare
// features that it was compiled for are marked as unlikely.
constexpr uint operator&(FeatureBits features, uint requested) {
    const uint found = features.bits & (requested & SHADING_FEATURES);
#ifdef SHADING_HAS_ALL_FEATURES
    return found;
#else
    return (requested & CommonFeatures) != 0u ? found : uint(__builtin_expect(found, 0));
#endif
}

SHADING_END

#endif

#endif
