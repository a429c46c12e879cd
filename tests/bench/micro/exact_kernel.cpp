// The kernel of one of the scenes of rare_feature_scenes.h; the build defines SHADING_KERNEL as the scene's
// name.
#define ORDINARY_FEATURES                                                               \
    (shading::FeatureTextures | shading::FeatureSpecular | shading::FeatureMeshLights | \
     shading::FeatureLightTree | shading::FeatureEnvironment)
#define FEATURES_none 0u
#define FEATURES_coat (shading::FeatureExtras | shading::FeatureCoat)
#define FEATURES_sheen (shading::FeatureExtras | shading::FeatureSheen)
#define FEATURES_anisotropy shading::FeatureExtras
#define FEATURES_rough_glass shading::FeatureRoughGlass
#define FEATURES_thin_glass shading::FeatureThinGlass
#define FEATURES_film (shading::FeatureExtras | shading::FeatureIridescence)
#define FEATURES_attenuation shading::FeatureMedia
#define FEATURES_fog (shading::FeatureMedia | shading::FeatureIndexMatchedMedia | shading::FeatureScattering)
#define FEATURES_motion shading::FeatureMotion
#define FEATURES_shader shading::FeatureSurfaceShader
#define FEATURES_catcher (shading::FeatureShadowCatcher | shading::FeatureAlpha)
#define FEATURES_area_lights (shading::FeatureAreaLights | shading::FeaturePunctualLights)
#define FEATURES_OF(scene) FEATURES_##scene
#define FEATURES(scene) FEATURES_OF(scene)
#define SHADING_FEATURES (ORDINARY_FEATURES | FEATURES(SHADING_KERNEL))
#define SHADING_HAS_ALL_FEATURES
#include "backends/embree/kernel_impl.h"
#include "tests/bench/micro/exact_kernels.h"

namespace tessera::embree {

const Kernel exact::SHADING_KERNEL{SHADING_FEATURES, trace};

}  // namespace tessera::embree
