#ifndef TESSERA_MEDIATOR_SHADING_THIN_FILM_H
#define TESSERA_MEDIATOR_SHADING_THIN_FILM_H

#include "mediator/shading/fresnel.h"

// A film about as thick as a wavelength, between air and a base: reflections from both of its interfaces
// interfere, which gives colours (Belcour and Barla 2017, KHR_materials_iridescence). The upper interface
// follows Fresnel's equations, the lower one Schlick's approximation, as the base without a film does.
// Cosines are those in air.
SHADING_BEGIN

struct ThinFilm {
    float strength;   // fraction of the surface covered by it; 0: no film
    float specular;   // factor of a dielectric's reflectance (KHR_materials_specular)
    float index;      // of refraction, at least 1
    float thickness;  // in nanometres
};

inline ThinFilm no_film() {
    return ThinFilm(0.0f, 1.0f, 1.0f, 0.0f);
}

// The index fades to that of air below the thickness of an atom, so that thickness 0 is no film.
inline ThinFilm make_film(float strength, float specular, float index, float thickness) {
    const float t = lesser_of(thickness / 0.03f, 1.0f);
    return ThinFilm(strength, specular, 1.0f + (index - 1.0f) * (t * t * (3.0f - 2.0f * t)), thickness);
}

// Properties of a film for one direction, independent of the base.
struct FilmLight {
    float amplitude;    // reflected by the upper interface at normal incidence
    float reflectance;  // of the upper interface
    float weight;       // Schlick's at the lower interface
    vec3 once, twice;   // mean cosine of the phase difference after one and two round trips, per colour
                        // channel
};

// Of four bands of wavelengths in Rec. 709. Belcour and Barla take the colour matching functions of CIE 1931
// for Gaussians over the wave number: X about 595 nm (the first band) and 446 nm (the last), Y about 557 nm,
// Z about 453 nm. White stays white: each row sums to 1.
inline vec3 film_colors(vec4 bands) {
    return vec3(dot(bands, vec4(2.27599198f, -1.27586199f, -0.413793075f, 0.413663085f)),
                dot(bands, vec4(-0.864910166f, 1.97828664f, 0.0438215385f, -0.157198009f)),
                dot(bands, vec4(0.0518082683f, -0.224489782f, 1.16326533f, 0.00941618786f)));
}

// Beyond this optical path difference, in nanometres, the interference averages to 0.
inline constexpr float MaxInterferencePath = 1e5f;

COLD_NOINLINE inline FilmLight film_light(IN(ThinFilm) film, float cos_out) {
    const float amplitude = (film.index - 1.0f) / (film.index + 1.0f);
    const float inside = sqrt(refracted_cosine2(cos_out, (1.0f - cos_out) * (1.0f + cos_out), film.index));
    const float path = lesser_of(2.0f * film.index * film.thickness * inside, MaxInterferencePath);
    const vec4 phase = vec4(0.0105620345f, 0.0112802026f, 0.0138757864f, 0.0140737068f) * path;
    const vec4 blur = vec4(1.70854696e-7f, 3.67330884e-7f, 2.61035245e-7f, 1.78766171e-7f) * (path * path);
    vec4 once = vec4(0.0f), twice = vec4(0.0f);
    NO_UNROLL
    for (int band = 0; band < 4; ++band) {
        const float turned = cosine(phase[band]), left = exponential(-blur[band]);
        once[band] = turned * left;
        twice[band] = (2.0f * turned * turned - 1.0f) * (left * left * left * left);
    }
    return FilmLight(amplitude, fresnel_dielectric(cos_out, film.index), schlick_weight(inside),
                     film_colors(once), film_colors(twice));
}

// Of a base with reflectance f0 in air at normal incidence. Airy's sum: the incoherent part and the first two
// orders of interference. Colours outside of Rec. 709 can be negative.
inline float thin_film_reflectance(IN(FilmLight) light, float once, float twice, float f0) {
    // Amplitudes of two boundaries add up like velocities (Einstein): this is (n - film) / (n + film).
    const float base = sqrt(clamp(f0, 0.0f, 1.0f));
    const float below = (base - light.amplitude) / (1.0f - base * light.amplitude);
    const float below2 = below * below;
    const float lower = below2 + (1.0f - below2) * light.weight;
    const float passes = 1.0f - light.reflectance;
    if (!(passes > 0.0f)) return 1.0f;
    const float both = light.reflectance * lower;
    const float from_below = passes * passes * lower / (1.0f - both);
    // Phase shift by half a wave at each interface towards a denser medium.
    const float round_trip = below > 0.0f ? -sqrt(both) : sqrt(both);
    const float order = 2.0f * (from_below - passes) * round_trip;
    return clamp(light.reflectance + from_below + order * (once + round_trip * twice), 0.0f, 1.0f);
}

inline vec3 thin_film_reflectances(IN(FilmLight) light, vec3 f0) {
    return vec3(thin_film_reflectance(light, light.once.x, light.twice.x, f0.x),
                thin_film_reflectance(light, light.once.y, light.twice.y, f0.y),
                thin_film_reflectance(light, light.once.z, light.twice.z, f0.z));
}

// Of a dielectric with this f0, including KHR_materials_specular.
inline vec3 thin_film_dielectric(IN(ThinFilm) film, IN(FilmLight) light, vec3 f0) {
    if (!(film.specular > 0.0f)) return vec3(0.0f);
    return film.specular * thin_film_reflectances(light, f0 / film.specular);
}

// Averages over all directions.
struct FilmMean {
    vec3 dielectric, metal;  // weighted by the cosine
    // Schlick's Fresnel with these is nowhere less than the largest channel of the dielectric: f90 may be
    // more than 1, for the reflectance of two boundaries rises faster than that of one.
    float f0, f90;
};

COLD_NOINLINE inline FilmMean film_mean(IN(ThinFilm) film, vec3 dielectric_f0, vec3 metal_f0) {
    const uint steps = 8u;
    FilmMean result = FilmMean(vec3(0.0f), vec3(0.0f), 0.0f, film.specular);
    NO_UNROLL
    for (uint i = steps; i > 0u; --i) {  // from the normal, where f0 shows, to where f90 does
        const float cos_out = float(i) / float(steps);
        const FilmLight light = film_light(film, cos_out);
        const vec3 dielectric = thin_film_dielectric(film, light, dielectric_f0);
        const float weight_here = (i == steps ? 1.0f : 2.0f * cos_out) / float(steps);  // trapezoids
        result.dielectric += weight_here * dielectric;
        result.metal += weight_here * thin_film_reflectances(light, metal_f0);
        const float weight = schlick_weight(cos_out), most = largest(dielectric);
        if (2u * i >= steps) {
            result.f0 = greater_of(result.f0, (most - film.specular * weight) / (1.0f - weight));
        } else {
            result.f90 = greater_of(result.f90, (most - result.f0 * (1.0f - weight)) / weight);
        }
    }
    return result;
}

SHADING_END

#endif
