// Writes the table of mediator/shading/energy.h as a C++ source: energy_table_generator FILE. In double, by a midpoint
// rule over the visible normals (GGX) or over the hemisphere (sheen); no random numbers, so that equal builds
// have equal bits.
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <vector>

#include "mediator/shading/energy.h"
#include "mediator/shading/microfacets.h"
#include "mediator/shading/sheen.h"

namespace {

using glm::dvec2;
using glm::dvec3;
using tessera::shading::EnergySteps;

constexpr double Pi = std::numbers::pi;
constexpr double Grazing = 1e-6;  // used instead of a cosine of 0, where all formulas are 0 / 0

// The i-th of `count` midpoints of the unit interval.
double midpoint(int i, int count) {
    return (i + 0.5) / count;
}

dvec3 direction(double cosine) {
    return {std::sqrt(1.0 - cosine * cosine), 0.0, cosine};
}

double ggx_lambda(const dvec3& w, double alpha) {
    const double tan2 = (1.0 - w.z * w.z) / (w.z * w.z);
    return 0.5 * (std::sqrt(1.0 + alpha * alpha * tan2) - 1.0);
}

// Heitz 2018.
dvec3 visible_normal(const dvec3& wo, double alpha, double u, double v) {
    const dvec3 s = glm::normalize(dvec3(alpha * wo.x, alpha * wo.y, wo.z));
    const double length2 = s.x * s.x + s.y * s.y;
    const dvec3 t1 = length2 > 0.0 ? dvec3(-s.y, s.x, 0.0) / std::sqrt(length2) : dvec3(1.0, 0.0, 0.0);
    const dvec3 t2 = glm::cross(s, t1);
    const double r = std::sqrt(u), phi = 2.0 * Pi * v, x = r * std::cos(phi), half = 0.5 * (1.0 + s.z);
    const double y = (1.0 - half) * std::sqrt(1.0 - x * x) + half * r * std::sin(phi);
    const dvec3 h = x * t1 + y * t2 + std::sqrt(std::max(0.0, 1.0 - x * x - y * y)) * s;
    return glm::normalize(dvec3(alpha * h.x, alpha * h.y, std::max(0.0, h.z)));
}

// Directional albedo at `cosine`: weights of Schlick's F0 and F90.
dvec2 ggx_energy(double cosine, double alpha, int points) {
    const dvec3 wo = direction(std::max(cosine, Grazing));
    const double lambda_out = ggx_lambda(wo, alpha);
    dvec2 sum(0.0);
    for (int i = 0; i < points; ++i) {
        for (int j = 0; j < points; ++j) {
            const dvec3 h = visible_normal(wo, alpha, midpoint(i, points), midpoint(j, points));
            const double out_h = glm::dot(wo, h);
            const dvec3 wi = 2.0 * out_h * h - wo;
            if (!(wi.z > 0.0)) continue;
            const double masking = (1.0 + lambda_out) / (1.0 + lambda_out + ggx_lambda(wi, alpha));
            const double weight = std::pow(1.0 - std::min(out_h, 1.0), 5.0);
            sum += masking * dvec2(1.0 - weight, weight);
        }
    }
    return sum / double(points * points);
}

dvec2 mean_ggx_energy(double alpha, int cosines, int points) {
    dvec2 sum(0.0);
    for (int i = 0; i < cosines; ++i) {
        const double cosine = midpoint(i, cosines);
        sum += 2.0 * cosine * ggx_energy(cosine, alpha, points) / double(cosines);
    }
    return sum;
}

// Fresnel's equations; 1 at total reflection.
double reflectance(double cosine, double eta) {
    const double inside2 = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
    if (!(inside2 > 0.0)) return 1.0;
    const double inside = std::sqrt(inside2);
    const double parallel = (eta * cosine - inside) / (eta * cosine + inside);
    const double across = (cosine - eta * inside) / (cosine + eta * inside);
    return 0.5 * (parallel * parallel + across * across);
}

// As glass_energy of energy.h.
dvec3 glass_energy(double cosine, double alpha, double eta, int points) {
    const dvec3 wo = direction(std::max(cosine, Grazing));
    const double lambda_out = ggx_lambda(wo, alpha);
    const auto masking = [&](double z) {
        return (1.0 + lambda_out) / (1.0 + lambda_out + ggx_lambda(direction(z), alpha));
    };
    const double amplitude = (1.0 - eta) / (1.0 + eta), start = amplitude * amplitude;
    dvec3 sum(0.0);
    for (int i = 0; i < points; ++i) {
        for (int j = 0; j < points; ++j) {
            const dvec3 h = visible_normal(wo, alpha, midpoint(i, points), midpoint(j, points));
            const double out_h = std::min(glm::dot(wo, h), 1.0);
            const double up = 2.0 * out_h * h.z - wo.z;
            const double reflects = up > 0.0 ? masking(up) : 0.0;
            const double inside2 = 1.0 - (1.0 - out_h * out_h) / (eta * eta);
            if (!(inside2 > 0.0)) {
                sum.x += reflects;
                continue;
            }
            const double down = std::sqrt(inside2) * h.z - (out_h * h.z - wo.z) / eta;
            const double passes = down > 0.0 ? masking(std::min(down, 1.0)) : 0.0;
            const double rise = std::max(0.0, (reflectance(out_h, eta) - start) / (1.0 - start));
            sum += dvec3(passes, reflects - passes, rise * (reflects - passes));
        }
    }
    return sum / double(points * points);
}

double sheen_lambda_fit(double x, double t) {
    const auto between = [t](double rough, double smooth) { return rough + (smooth - rough) * t; };
    return between(21.5473, 25.3245) /
               (1.0 + between(3.82987, 3.32435) * std::pow(x, between(0.19823, 0.16801))) +
           between(-1.97760, -1.27393) * x + between(-4.32054, -4.85967);
}

double sheen_lambda(double cosine, double alpha) {
    const double t = (1.0 - alpha) * (1.0 - alpha);
    if (cosine < 0.5) return std::exp(sheen_lambda_fit(cosine, t));
    return std::exp(2.0 * sheen_lambda_fit(0.5, t) - sheen_lambda_fit(1.0 - cosine, t));
}

double sheen_energy(double cosine, double alpha, int points) {
    const dvec3 wo = direction(std::max(cosine, Grazing));
    const double lambda_out = sheen_lambda(wo.z, alpha);
    double sum = 0.0;
    for (int i = 0; i < points; ++i) {
        const double z = midpoint(i, points), lambda_in = sheen_lambda(z, alpha);
        for (int j = 0; j < points; ++j) {
            const double phi = 2.0 * Pi * midpoint(j, points), r = std::sqrt(1.0 - z * z);
            const dvec3 h = glm::normalize(wo + dvec3(r * std::cos(phi), r * std::sin(phi), z));
            const double sine2 = h.x * h.x + h.y * h.y;
            const double d = (2.0 + 1.0 / alpha) / (2.0 * Pi) * std::pow(sine2, 0.5 / alpha);
            sum += d / (4.0 * wo.z * (1.0 + lambda_out + lambda_in));
        }
    }
    return sum * 2.0 * Pi / (points * points);
}

// For each direction and roughness of the table.
template <class Value>
void for_each_entry(const Value& value) {
    for (unsigned row = 0; row < EnergySteps; ++row) {
        for (unsigned column = 0; column < EnergySteps; ++column) {
            value(column / double(EnergySteps - 1), row / double(EnergySteps - 1));
        }
    }
}

// The inverse of energy_direction.
double root_of_cosine(double direction, double roughness) {
    return direction < 1.0 ? direction * roughness / (1.0 + roughness - direction) : 1.0;
}

double ggx_alpha(double roughness) {
    return std::max(roughness * roughness, double(tessera::shading::MinAlpha));
}

// For each side, index and roughness of the tables of glass. An infinite index: one of 10,000.
template <class Value>
void for_each_glass(const Value& value) {
    using tessera::shading::GlassIndices, tessera::shading::GlassRoughnesses;
    for (unsigned side = 0; side < 2; ++side) {
        for (unsigned layer = 0; layer < GlassIndices; ++layer) {
            const double critical = layer / double(GlassIndices - 1);
            const double ratio = std::max(std::sqrt(1.0 - critical * critical), 1e-4);
            for (unsigned row = 0; row < GlassRoughnesses; ++row) {
                value(side == 0 ? 1.0 / ratio : ratio,
                      std::pow(row / double(GlassRoughnesses - 1), 2.0 / 3.0));
            }
        }
    }
}

std::vector<dvec3> glass_row(double eta, double roughness) {
    std::vector<dvec3> row;
    for (unsigned column = 0; column < tessera::shading::GlassDirections; ++column) {
        const double root = root_of_cosine(column / double(tessera::shading::GlassDirections - 1), roughness);
        row.push_back(glass_energy(root * root, ggx_alpha(roughness), eta, 64));
    }
    return row;
}

// Weighted by the cosine, of the row as it is interpolated: what multiple scattering gives back is then what it takes.
dvec3 mean_of_row(const std::vector<dvec3>& row, double roughness) {
    constexpr int Cosines = 1024;
    dvec3 sum(0.0);
    for (int i = 0; i < Cosines; ++i) {
        const double cosine = midpoint(i, Cosines), root = std::sqrt(cosine);
        const double direction = root * (1.0 + roughness) / (root + roughness);
        const double place = direction * double(row.size() - 1);
        const auto column = std::min(static_cast<std::size_t>(place), row.size() - 2);
        const dvec3 energy = row[column] + (row[column + 1] - row[column]) * (place - double(column));
        sum += 2.0 * cosine * energy / double(Cosines);
    }
    return sum;
}

}  // namespace

int main(int count, char** arguments) {
    std::FILE* file = count == 2 ? std::fopen(arguments[1], "w") : nullptr;
    if (file == nullptr) return 1;
    std::fputs(
        "#include \"mediator/backend/tables/tables.h\"\n"
        "#include \"mediator/shading/energy.h\"\n"
        "namespace tessera::backend {\n"
        "std::span<const float> energy_values() {\n"
        "static constexpr float Numbers[shading::EnergyCount] = {\n",
        file);
    const auto put = [&](double value) { std::fprintf(file, "%.9g,\n", value); };
    for_each_entry([&](double place, double roughness) {
        const double root = root_of_cosine(place, roughness);
        const dvec2 energy = ggx_energy(root * root, ggx_alpha(roughness), 128);
        put(energy.x + energy.y);
    });
    for_each_entry([&](double root, double roughness) {
        const dvec2 energy = ggx_energy(root * root, ggx_alpha(roughness), 128);
        put(energy.y / (energy.x + energy.y));
    });
    for (unsigned row = 0; row < EnergySteps; ++row) {
        const dvec2 energy = mean_ggx_energy(ggx_alpha(row / double(EnergySteps - 1)), 64, 64);
        put(energy.x);
        put(energy.y);
    }
    for_each_entry([&](double root, double roughness) {
        const double r = std::max(roughness, double(tessera::shading::MinSheenRoughness));
        put(sheen_energy(root * root, r * r, 256));
    });
    const auto put_three = [&](const dvec3& values) {
        put(values.x);
        put(values.y);
        put(values.z);
    };
    std::vector<dvec3> means;
    for_each_glass([&](double eta, double roughness) {
        const std::vector<dvec3> row = glass_row(eta, roughness);
        for (const dvec3& energy : row) put_three(energy);
        means.push_back(mean_of_row(row, roughness));
    });
    for (const dvec3& energy : means) put_three(energy);
    std::fputs("};\nreturn Numbers;\n}\n}  // namespace tessera::backend\n", file);
    return std::fclose(file) == 0 ? 0 : 1;
}
