#ifndef TESSERA_MEDIATOR_SHADING_RECORDS_H
#define TESSERA_MEDIATOR_SHADING_RECORDS_H

#include "mediator/shading/language.h"

// What a renderer looks up, as it lies in memory: the same bytes for C++ and GLSL (scalar layout; asserted in
// layout.h). Places are relative to the render origin. Tables are ordered by object id: a function of the
// scene's content alone. Arrays are reached by address: a host pointer on the CPU, a device address on a GPU;
// a record says by a count or a flag whether an array is there.
RECORDS_BEGIN

ARRAY_OF(float, FloatArray, 4);
ARRAY_OF(uint, UintArray, 4);
ARRAY_OF(vec2, Vec2Array, 4);
ARRAY_OF(vec3, Vec3Array, 4);
ARRAY_OF(vec4, Vec4Array, 4);
ARRAY_OF(uvec3, UVec3Array, 4);

// Values as in scene/objects.h.
inline constexpr uint TexelRgba8 = 0u, TexelRgba8Srgb = 1u, TexelRgbFloat = 2u;
inline constexpr uint TexelRgba8Signed = 3u;  // bytes of -127 to 127: a use of Rgba8
inline constexpr uint NormalTangent = 0u, NormalObject = 1u;
inline constexpr uint WrapRepeat = 0u, WrapMirror = 1u, WrapClamp = 2u;
inline constexpr uint TextureLinear = 0u, TextureNearest = 1u;
inline constexpr uint AlphaOpaque = 0u, AlphaMask = 1u, AlphaBlend = 2u;

// Rows from the top, without gaps. Rgba8: red in the lowest byte; RgbFloat: three floats a texel. Levels are
// the same picture at half the size (rounded down, at least 1) and half of that and so on, one after the
// other.
struct Texture {
    UintArray texels;
    UintArray levels;
    uint width;
    uint height;
    uint format;
    uint wrap_s;
    uint wrap_t;
    uint texture_filter;
    uint level_count;  // without the picture itself
    uint depth;        // slices, one after the other; only bodies look at more than the first
};

// A use of a texture, with its transform: u' = dot(row_u, uv) + offset.x, and v' likewise.
struct TextureUse {
    int texture;  // index; -1 = none
    uint set;     // of texture coordinates: 0 or 1
    vec2 row_u;
    vec2 row_v;
    vec2 offset;
};

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
    uint double_sided;  // 1 or 0, as all that could be a bool
    uint unlit;
    uint thin;   // walls instead of a body
    int extras;  // index; -1 = none
    int shader;  // index; -1 = none
};

// What few materials have. Textures that are looked up in a loop: written out, lookups are most of a kernel.
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
    vec2 film_thickness;  // least and greatest, in nanometres
    TextureUse textures[ExtrasTextureCount];
    TextureUse coat_normal_texture;
    TextureUse anisotropy_texture;
};

inline constexpr uint ShaderSpecular = 0u, ShaderShininess = 1u, ShaderReflection = 2u,
                      ShaderTransmission = 3u, ShaderTextureCount = 4u;
// What only CommonSurfaceShader has (Schwenk 5.A.3); its diffuse part, emission and normal map are a
// Material's.
struct Shader {
    vec3 specular;
    float fresnel_blend;
    vec2 shininess;
    vec3 reflection;
    float height_scale;
    vec3 transmission;
    uint normal_space;
    vec3 index_of_refraction;  // inside / outside, for each channel
    uint inverts_alpha;
    vec3 environment;
    int tangent_set;  // of texture coordinates, whose u grows along the tangent; -1: as the mesh says
    vec3 normal_scale;
    int binormal_set;
    vec3 normal_bias;
    TextureUse textures[ShaderTextureCount];
    TextureUse alpha_texture;
    TextureUse height_texture;
    TextureUse environment_texture;
};

// Which of a mesh's arrays are there besides positions and triangles.
inline constexpr uint MeshNormals = 1u, MeshTangents = 2u, MeshColors = 4u, MeshTexCoords = 8u,
                      MeshTexCoords1 = 16u, MeshBends = 32u;

// Vertices at a step of a mesh's motion; normals where the mesh has some.
struct MeshStep {
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
    uint first_step;  // of MeshBends: index of the beginning's
    uint steps;       // after it
    float reach;      // of any coordinate at any step
    float share;      // of a mesh at a time (motion.h): of the way from `positions` and `normals` to
    Vec3Array next_positions;
    Vec3Array next_normals;
};

inline constexpr uint AllLayers = 0xffffffffu;
inline constexpr int ShadowCatcher = -2;

// Where something is at a step of its motion: world from its own space.
struct Place {
    mat3 linear;
    vec3 translation;
};

// A way through places that stand together, at even steps of time; between them all goes in a straight line.
struct Motion {
    uint first_place;
    uint steps;   // after it; at least 1
    float sizes;  // of any element of `linear` at any step, at most
    vec3 reach;   // of the translation, likewise
};

struct Instance {
    uint mesh;      // index
    uint material;  // index
    uint object;    // id of the geometry
    int light;      // index, if it emits and can be hit; else -1, or ShadowCatcher
    mat3 linear;    // world from object
    vec3 translation;
    mat3 normals;       // cofactors of `linear` times a power of two: they turn normals, to their own side
    uint alpha_tested;  // whether a hit has to be asked (stops_at)
    uint layers;        // not there for views that see none of them
    int motion;         // index; -1 = it stands still
    int body;           // index; -1 = nothing but its surface
};

inline constexpr uint BodyAbsorption = 0u, BodyScattering = 1u, BodyEmission = 2u, BodyTextureCount = 3u;
// What a closed geometry is filled with (Schwenk 5.B.3), per metre of the world. Textures lie in the box around
// the geometry, in its own space: u along x, v against y, slices along z.
struct Body {
    vec3 absorption;
    int priority;  // where bodies overlap, the highest fills them; of equal ones that which was entered last
    vec3 scattering;
    float anisotropy;  // Henyey and Greenstein's g
    vec3 emission;     // radiance
    uint open;         // its surface is none: rays go through
    vec3 low;          // of the box
    uint textured;     // whether any of the textures is there
    vec3 inverse_size;
    float index;  // of refraction; 0: without bound; -1: that of what is around it
    TextureUse textures[BodyTextureCount];
};
// That a place is in at once; those of the least priority are forgotten.
inline constexpr uint MaxBodies = 4u;

inline constexpr uint LightPoint = 0u, LightSpot = 1u, LightDirectional = 2u, LightMesh = 3u,
                      LightEnvironment = 4u, LightSphere = 5u, LightQuad = 6u;

struct LightSource {
    uint kind;
    float probability;  // of being chosen, if it is infinitely far: the others are in the light tree
    vec3 intensity;     // of what has a size (sphere, quad, sun): its radiance
    vec3 position;
    vec3 direction;  // in which it shines
    float cos_inner;
    float cos_outer;
    float radius;  // of a sphere
    float cap;  // of a sun: 1 - the cosine of half the angle that it spans; 0 = no sun but a point in the sky
    vec3 edge_u;  // of a quad: directions of its edges, of unit length
    vec3 edge_v;
    vec2 half_size;      // along them
    uint instance;       // of a mesh light
    uint first_emitter;  // of a mesh light: that of its first triangle; else its own
    uint layers;         // as of an instance
    int motion;          // of a light that is no mesh, likewise
};

// What the light tree chooses: a triangle of a mesh light, or a light of its own.
struct Emitter {
    uint light;               // index
    uint triangle;            // of the mesh
    uint node;                // its leaf; NoLightNode where no light comes from it
    float inverse_root_area;  // 1 / square root of its area in the world, which may leave the range of
                              // floats; 0: its area changes, and is asked for (motion.h)
};
inline constexpr uint NoLightNode = 0xffffffffu;

// A node of the light tree: all of its emitters, in short (Conty Estevez and Kulla 2018). Node 0 is the root;
// children stand together.
struct LightNode {
    vec3 middle;  // of a ball around them
    float radius;
    vec3 axis;         // of a cone around the directions that they face
    float cos_spread;  // of its half angle; -1: all directions
    float cos_reach;   // of the angle to which each shines around its own direction
    float power;       // as a share of the tree's; more than 0
    uint link;         // the first child, or the emitter of a leaf; and the bits below
    uint parent;
};
inline constexpr uint LightLeaf = 0x80000000u, LightTwoSided = 0x40000000u, LightIndexBits = 0x03ffffffu;
inline constexpr uint LightShaped = 0x08000000u;  // there are spheres or quads below
inline constexpr uint LightByPower =
    0x04000000u;  // children are triangles of one flat lamp: power tells enough
inline constexpr uint LightCountShift = 28u, MaxLightChildren = 4u;  // two bits: children - 1

// Light from infinitely far: color + strength x map. A map of width 0 is none.
struct Environment {
    Texture map;
    vec3 color;
    float strength;
    float rotation;
    uint row_sums;     // index of the rows' cumulative weights
    uint column_sums;  // index of the cumulative weights of the texels of each row
    uint emits;
    vec4 visible_color;  // with alpha: what camera rays see that hit nothing, if it is
    uint shows_color;    // and not the light
    uint unused;         // keeps the size a multiple of an address's
};

// What occurs in a scene; what does not can be left out of a kernel.
inline constexpr uint FeatureTextures = 1u, FeatureNormalMaps = 2u, FeatureAlpha = 4u, FeatureSpecular = 8u,
                      FeaturePlacedLights = 16u, FeatureMeshLights = 32u, FeatureEnvironment = 64u,
                      FeatureEnvironmentMap = 128u;
// Lobes that few materials have, and whether any material has extras.
inline constexpr uint FeatureCoat = 4096u, FeatureSheen = 8192u, FeatureRoughGlass = 16384u,
                      FeatureExtras = 32768u, FeatureIridescence = 0x8000000u;
// Of a scene and a view together: some of it is in none of the view's layers.
inline constexpr uint FeatureLayers = 256u;
// More than one emitter; spheres and quads; suns.
inline constexpr uint FeatureLightTree = 0x10000u, FeatureShapedLights = 0x20000u, FeatureSuns = 0x40000u;
inline constexpr uint FeatureShadowCatcher = 0x80000u;
// While the shutter is open something moves; of a view: its camera does.
inline constexpr uint FeatureMotion = 0x2000000u, FeatureCameraMotion = 0x4000000u;
// CommonSurfaceShader.
inline constexpr uint FeatureShader = 0x800000u;
// Bodies that do something to light; some have no surface; some scatter; some have textures.
inline constexpr uint FeatureMedia = 0x1000000u, FeatureOpenMedia = 0x10000000u,
                      FeatureScattering = 0x20000000u, FeatureMediaTextures = 0x40000000u;
// Of bodies that are glass, some may lie in others.
inline constexpr uint FeatureNestedGlass = 0x80000000u;

ARRAY_OF(Texture, TextureArray, 8);
ARRAY_OF(Material, MaterialArray, 4);
ARRAY_OF(MaterialExtras, MaterialExtrasArray, 4);
ARRAY_OF(Shader, ShaderArray, 4);
ARRAY_OF(Mesh, MeshArray, 8);
ARRAY_OF(MeshStep, MeshStepArray, 8);
ARRAY_OF(Place, PlaceArray, 4);
ARRAY_OF(Motion, MotionArray, 4);
ARRAY_OF(Instance, InstanceArray, 4);
ARRAY_OF(Body, BodyArray, 4);
ARRAY_OF(LightSource, LightSourceArray, 4);
ARRAY_OF(Emitter, EmitterArray, 4);
ARRAY_OF(LightNode, LightNodeArray, 4);

struct Scene {
    TextureArray textures;
    MaterialArray materials;
    MaterialExtrasArray extras;
    ShaderArray shaders;
    MeshArray meshes;
    InstanceArray instances;
    LightSourceArray lights;  // those in the tree, then those infinitely far
    EmitterArray emitters;
    LightNodeArray light_nodes;
    FloatArray sums;    // all cumulative sums: whoever has some knows the index of the first
    FloatArray srgb;    // linear value of each byte (IEC 61966-2-1)
    FloatArray energy;  // what lobes reflect (energy.h)
    MeshStepArray mesh_steps;
    PlaceArray places;
    MotionArray motions;
    BodyArray bodies;
    Environment environment;
    uint instance_count;
    uint light_count;
    uint tree_light_count;   // of them in the tree
    uint light_sums;         // index of cumulative probabilities: of the tree, then of each distant light
    float tree_probability;  // of being chosen
    int environment_light;   // index of the light source that stands for the environment, or -1
    FeatureBits features;
    float tree_scale;  // a power of two that brings the light tree's size near to 1
};

// Values as in view/view.h.
inline constexpr uint FilterBox = 0u, FilterGaussian = 1u, FilterBlackmanHarris = 2u;
inline constexpr uint RendererPathTracing = 0u, RendererWhitted = 1u, RendererRaster = 2u,
                      RendererCoverage = 3u;
inline constexpr uint ClassIndirect = 0u, ClassCaustics = 1u, ClassDiffuse = 2u, ClassAll = 3u,
                      ClassNone = 4u;
inline constexpr uint RuleDemodulated = 0u, RuleConnections = 1u;
// How light is found; the estimates agree in expectation. Only tests choose other than both.
inline constexpr uint StrategyBoth = 0u, StrategyLightsOnly = 1u, StrategyBsdfOnly = 2u;
// Of places in media where light is looked for, that of both ways (equiangular.h).
inline constexpr uint StrategyFlightOnly = 3u, StrategyEquiangularOnly = 4u;
inline constexpr uint CameraPinhole = 0u, CameraOrthographic = 1u, CameraLens = 2u, CameraGaussian = 4u;
// What a sample has to keep besides its light.
inline constexpr uint KeepsDiffuse = 1u, KeepsConnections = 2u, KeepsRange = 4u;
inline constexpr uint UnlimitedScatterings = 0xffffffffu;

struct View {
    uint64_t seed;
    vec3 eye;
    vec3 right;
    vec3 up;
    vec3 forward;
    vec2 middle;  // of the picture, at distance 1 in front of the eye; orthographic: in metres
    vec2 step;    // from pixel to pixel there; y down the picture
    uint width;
    uint height;
    uint pixel_filter;
    float filter_radius;
    uint max_scatterings;
    uint renderer;
    uint path_class;
    uint feature_rule;
    uint channels;  // bits as in frame/channels.h
    uint keeps;
    uint transparent_background;
    uint strategy;
    uint layers;  // that it sees
    uint camera;  // bits, CameraPinhole for the usual one
    float lens_radius;
    float focus_distance;
    PlaceArray camera_places;  // where it moves: the beginning's and those of the steps after it
    uint camera_steps;
    uvec4 inside;  // instances of the bodies that the eye is in (bodies.h)
    uint unused;   // keeps the size a multiple of an address's
};

RECORDS_END

#ifdef __cplusplus

SHADING_BEGIN

// What most scenes have some of.
inline constexpr uint CommonFeatures =
    FeatureTextures | FeatureSpecular | FeatureMeshLights | FeatureEnvironment | FeatureLightTree;

// What a kernel was not compiled for is not there: the compiler sees it. What it was compiled for and is not
// common is kept out of the way of what is.
constexpr uint operator&(FeatureBits features, uint asked) {
    const uint found = features.bits & (asked & SHADING_FEATURES);
#ifdef SHADING_HAS_ALL_FEATURES
    return found;
#else
    return (asked & CommonFeatures) != 0u ? found : uint(__builtin_expect(found, 0));
#endif
}

SHADING_END

#endif

#endif
