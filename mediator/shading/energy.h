#ifndef TESSERA_MEDIATOR_SHADING_ENERGY_H
#define TESSERA_MEDIATOR_SHADING_ENERGY_H

#include "mediator/shading/fresnel.h"
#include "mediator/shading/records.h"

// Directional albedos of lobes, from tables over direction and roughness (generated at build time,
// backend/tables/energy_table_generator.cpp). A lobe with Schlick's Fresnel reflects f0 x + f90 y of a pair
// (x, y).
SHADING_BEGIN

// Table resolution in direction and roughness, both 0 to 1. The tables in order: GGX, without Fresnel losses,
// over `energy_direction`; GGX, the mean of Schlick's weight, over the root of the cosine; both means over
// the hemisphere, for each roughness; sheen, over the root of the cosine.
inline constexpr uint EnergySteps = 32u;
inline constexpr uint SchlickEnergies = EnergySteps * EnergySteps;
inline constexpr uint MeanEnergies = 2u * SchlickEnergies;
inline constexpr uint SheenEnergies = MeanEnergies + 2u * EnergySteps;
inline constexpr uint GlassEnergies = SheenEnergies + EnergySteps * EnergySteps;

// Then those of a boundary of two dielectrics, three floats for each: over `energy_direction`, over roughness to the
// power of 1.5, over the cosine of the critical angle, from outside (far side denser) and from inside; and their means
// over all directions.
inline constexpr uint GlassDirections = 20u, GlassRoughnesses = 28u, GlassIndices = 20u;
inline constexpr uint GlassEntries = 2u * GlassIndices * GlassRoughnesses * GlassDirections;
inline constexpr uint MeanGlassEnergies = GlassEnergies + 3u * GlassEntries;
inline constexpr uint EnergyCount = MeanGlassEnergies + 3u * 2u * GlassIndices * GlassRoughnesses;

// Multiple scattering below this fraction (mean over all directions) is left out: it leaves at grazing
// angles, where no lobe would sample it.
inline constexpr float MinMultiscatter = 1e-3f;

// Table coordinate of the direction: shadowing depends on the ratio of the cosine and alpha.
inline float energy_direction(float root_of_cosine, float roughness) {
    const float sum = root_of_cosine + roughness;
    return sum > 0.0f ? root_of_cosine * (1.0f + roughness) / sum : 1.0f;
}

inline float energy_between(FloatArray table, uint start, float direction, float roughness) {
    const float x = clamp(direction, 0.0f, 1.0f) * float(EnergySteps - 1u);
    const float y = clamp(roughness, 0.0f, 1.0f) * float(EnergySteps - 1u);
    const uint column = min(uint(x), EnergySteps - 2u), row = min(uint(y), EnergySteps - 2u);
    const uint i = start + row * EnergySteps + column, j = i + EnergySteps;
    const float across = x - float(column);
    const float near = table.items[i] + (table.items[i + 1u] - table.items[i]) * across;
    const float far = table.items[j] + (table.items[j + 1u] - table.items[j]) * across;
    return near + (far - near) * (y - float(row));
}

// Albedo of the GGX lobe, single scattering only.
inline vec2 lobe_energy(FloatArray table, float cosine, float roughness) {
    const float root = sqrt(clamp(cosine, 0.0f, 1.0f));
    const float all = energy_between(table, 0u, energy_direction(root, roughness), roughness);
    const float weight = energy_between(table, SchlickEnergies, root, roughness);
    return vec2(all * (1.0f - weight), all * weight);
}

// Its mean over all directions, weighted by the cosine.
inline vec2 mean_lobe_energy(FloatArray table, float roughness) {
    const float y = clamp(roughness, 0.0f, 1.0f) * float(EnergySteps - 1u);
    const uint row = min(uint(y), EnergySteps - 2u);
    const uint i = MeanEnergies + 2u * row;
    const vec2 near = vec2(table.items[i], table.items[i + 1u]);
    const vec2 far = vec2(table.items[i + 2u], table.items[i + 3u]);
    return near + (far - near) * (y - float(row));
}

// Place in the tables of glass: entry of the row of roughness and index, and fractions towards the next ones.
struct GlassPlace {
    uint row;
    float between_roughnesses, between_indices;
};

inline GlassPlace glass_place(float eta, float roughness) {
    const float ratio = eta < 1.0f ? eta : 1.0f / eta;
    const float critical = sqrt((1.0f - ratio) * (1.0f + ratio));
    const float z = lesser_of(critical, 1.0f) * float(GlassIndices - 1u);
    const float rough = clamp(roughness, 0.0f, 1.0f);
    const float y = rough * sqrt(rough) * float(GlassRoughnesses - 1u);
    const uint layer = min(uint(z), GlassIndices - 2u), row = min(uint(y), GlassRoughnesses - 2u);
    const uint side = eta < 1.0f ? GlassIndices : 0u;
    return GlassPlace((side + layer) * GlassRoughnesses + row, y - float(row), z - float(layer));
}

inline vec3 three_energies(FloatArray table, uint start, uint entry) {
    const uint i = start + 3u * entry;
    return vec3(table.items[i], table.items[i + 1u], table.items[i + 2u]);
}

inline vec3 glass_energy_in_row(FloatArray table, uint row, uint column, float across) {
    const vec3 near = three_energies(table, GlassEnergies, row * GlassDirections + column);
    const vec3 far = three_energies(table, GlassEnergies, row * GlassDirections + column + 1u);
    return near + (far - near) * across;
}

// Albedo of a boundary for single scattering: with a Fresnel term f0 + (f90 - f0) r, r from 0 to 1, and total
// reflection, x + f0 y + (f90 - f0) z. eta = index of refraction on the far side / on this side.
inline vec3 glass_energy(FloatArray table, float eta, float cosine, float roughness) {
    const GlassPlace place = glass_place(eta, roughness);
    const float direction = energy_direction(sqrt(clamp(cosine, 0.0f, 1.0f)), roughness);
    const float x = clamp(direction, 0.0f, 1.0f) * float(GlassDirections - 1u);
    const uint column = min(uint(x), GlassDirections - 2u);
    const float across = x - float(column);
    vec3 near = glass_energy_in_row(table, place.row, column, across);
    vec3 far = glass_energy_in_row(table, place.row + GlassRoughnesses, column, across);
    near += (glass_energy_in_row(table, place.row + 1u, column, across) - near) * place.between_roughnesses;
    far += (glass_energy_in_row(table, place.row + GlassRoughnesses + 1u, column, across) - far) *
           place.between_roughnesses;
    return near + (far - near) * place.between_indices;
}

// Its mean over all directions, weighted by the cosine.
inline vec3 mean_glass_energy(FloatArray table, float eta, float roughness) {
    const GlassPlace place = glass_place(eta, roughness);
    vec3 near = three_energies(table, MeanGlassEnergies, place.row);
    vec3 far = three_energies(table, MeanGlassEnergies, place.row + GlassRoughnesses);
    near += (three_energies(table, MeanGlassEnergies, place.row + 1u) - near) * place.between_roughnesses;
    far += (three_energies(table, MeanGlassEnergies, place.row + GlassRoughnesses + 1u) - far) *
           place.between_roughnesses;
    return near + (far - near) * place.between_indices;
}

// Albedo of white sheen; may exceed 1.
inline float sheen_energy(FloatArray table, float cosine, float roughness) {
    return energy_between(table, SheenEnergies, sqrt(clamp(cosine, 0.0f, 1.0f)), roughness);
}

// Mean of Schlick's Fresnel over the hemisphere, weighted by the cosine.
inline float mean_schlick(float f0, float f90) {
    return f0 + (f90 - f0) * (1.0f / 21.0f);
}

// Multiple scattering energy compensation: the fraction of light that a facet reflects to another facet and
// that finally leaves; f: mean reflectance of the facets, e: mean single scattering albedo (Kulla and Conty
// 2017): f^2 e / (1 - f (1 - e)).
inline float multiscatter_fraction(float f, float e) {
    return f * f * e / (1.0f - f * (1.0f - e));
}

inline vec3 multiscatter_fractions(vec3 f, float e) {
    return f * f * e / (1.0f - f * (1.0f - e));
}

SHADING_END

#endif
