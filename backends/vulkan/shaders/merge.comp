#version 460
// Merges samples of a whole tile into a block, bit for bit as frame::merge on the host. One invocation is one
// pixel of one column of values. Cases that need the general form on the host (non-finite samples) or that a
// device may round differently (denormals, which many flush to 0) are only flagged: the host then merges the
// samples itself.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 0) in;

// As in merge_columns.h.
const uint Moments = 0u, Sum = 1u, Minimum = 2u, Maximum = 3u, Nearest = 4u, First = 5u, Count = 6u,
           BlockVariance = 7u, FirstHalf = 8u;
struct Column {
    uint rule;
    uint value;
    uint components;
    uint plane;
};

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Columns {
    Column items[];
};
// Read and written as bits: a record's payload may look like a signalling NaN.
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Values {
    uint items[];
};
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Planes {
    uint items[];
};
// As struct MergeJob in job.h.
layout(push_constant, scalar) uniform Arguments {
    Columns columns;
    Values values;
    Planes planes;
    uint pixels, level;
    uint column_count, plane_count;
}
job;

const uint MaxLevel = 8u;
const uint ExponentBits = 0x7f800000u;

bool is_finite(uint bits) {
    return (bits & ExponentBits) != ExponentBits;
}
bool is_nan(uint bits) {
    return (bits & 0x7fffffffu) > ExponentBits;
}
bool is_subnormal(uint bits) {
    return (bits & ExponentBits) == 0u && (bits & 0x7fffffffu) != 0u;
}
// For a result that is not exactly 0: whether it is denormal or overflows.
bool left_range(float x) {
    const uint exponent = floatBitsToUint(x) & ExponentBits;
    return exponent == 0u || exponent == ExponentBits;
}

// Sets `leaves` if the host has to compute the sum.
float added(float a, float b, inout bool leaves) {
    precise const float sum = a + b;
    leaves = leaves || (a != -b && left_range(sum));
    return sum;
}

uint value_of(uint k, uint pixel, uint s) {
    return job.values.items[((k << job.level) + s) * job.pixels + pixel];
}
void put(uint plane, uint pixel, uint bits) {
    job.planes.items[plane * job.pixels + pixel] = bits;
}

// Equal neighbours merge like the carries of a binary counter, as in frame::BlockStack.
void merge_moments(Column column, uint pixel, inout bool leaves) {
    float means[MaxLevel + 1u], m2s[MaxLevel + 1u];
    float mean = 0.0, m2 = 0.0;
    for (uint s = 0u; s < 1u << job.level; ++s) {
        const uint bits = value_of(column.value, pixel, s);
        leaves = leaves || !is_finite(bits) || is_subnormal(bits);
        mean = uintBitsToFloat(bits);
        m2 = 0.0;
        uint level = 0u;
        float half_count = 0.5;
        for (uint carry = s; (carry & 1u) == 1u; carry >>= 1u) {
            const float earlier = means[level];
            precise const float difference = earlier - mean;
            precise const float square = difference * difference;
            precise const float spread = square * half_count;
            leaves = leaves || (earlier != mean &&
                                (left_range(difference) || left_range(square) || left_range(spread)));
            m2 = added(added(m2s[level], m2, leaves), spread, leaves);
            const float both = added(earlier, mean, leaves);
            precise const float midpoint = both * 0.5;
            leaves = leaves || (both != 0.0 && left_range(midpoint));
            mean = midpoint;
            level += 1u;
            half_count *= 2.0;
        }
        means[level] = mean;
        m2s[level] = m2;
    }
    put(column.plane, pixel, floatBitsToUint(mean));
    put(column.plane + column.components, pixel, floatBitsToUint(m2));
}

void merge_sum(Column column, uint pixel, inout bool leaves) {
    float sums[MaxLevel + 1u];
    float sum = 0.0;
    for (uint s = 0u; s < 1u << job.level; ++s) {
        const uint bits = value_of(column.value, pixel, s);
        leaves = leaves || !is_finite(bits) || is_subnormal(bits);
        sum = uintBitsToFloat(bits);
        uint level = 0u;
        for (uint carry = s; (carry & 1u) == 1u; carry >>= 1u) {
            sum = added(sums[level], sum, leaves);
            level += 1u;
        }
        sums[level] = sum;
    }
    put(column.plane, pixel, floatBitsToUint(sum));
}

vec3 radiance_of(Column column, uint pixel, uint s) {
    return vec3(uintBitsToFloat(value_of(column.value, pixel, s)),
                uintBitsToFloat(value_of(column.value + 1u, pixel, s)),
                uintBitsToFloat(value_of(column.value + 2u, pixel, s)));
}

// As in frame/merge.cpp.
float squared_difference(vec3 a, vec3 b, inout bool leaves) {
    const vec3 weights = vec3(0.2126, 0.7152, 0.0722);
    float sum = 0.0;
    for (int c = 0; c < 3; ++c) {
        precise const float difference = a[c] - b[c];
        precise const float square = difference * difference;
        precise const float part = weights[c] * square;
        leaves = leaves ||
                 (a[c] != b[c] && (left_range(difference) || left_range(square) || left_range(part)));
        sum = added(sum, part, leaves);
    }
    return sum;
}

float halved(float x, inout bool leaves) {
    precise const float half_of = x * 0.5;
    leaves = leaves || (x != 0.0 && left_range(half_of));
    return half_of;
}

// Channels that follow from the means of radiance. Those are checked by their own columns.
void merge_derived(Column column, uint pixel, inout bool leaves) {
    vec3 means[MaxLevel + 1u];
    float tops[MaxLevel + 1u];
    vec3 first_half = vec3(0.0);
    float top = 0.0, below = 0.0;
    for (uint s = 0u; s < 1u << job.level; ++s) {
        vec3 mean = radiance_of(column, pixel, s);
        top = 0.0;
        below = 0.0;
        uint level = 0u;
        for (uint carry = s; (carry & 1u) == 1u; carry >>= 1u) {
            first_half = means[level];
            if (column.rule == BlockVariance) {
                below = halved(added(tops[level], top, leaves), leaves);
                top = halved(halved(squared_difference(first_half, mean, leaves), leaves), leaves);
            }
            for (int c = 0; c < 3; ++c) {
                precise const float sum = first_half[c] + mean[c];
                precise const float midpoint = sum * 0.5;
                mean[c] = midpoint;
            }
            level += 1u;
        }
        means[level] = mean;
        tops[level] = top;
    }
    if (column.rule == BlockVariance) {
        put(column.plane, pixel, floatBitsToUint(top));
        put(column.plane + 1u, pixel, floatBitsToUint(below));
        return;
    }
    for (int c = 0; c < 3; ++c) put(column.plane + uint(c), pixel, floatBitsToUint(first_half[c]));
    put(column.plane + 3u, pixel, floatBitsToUint(float((1u << job.level) / 2u)));
}

// The first record with the smallest (or largest) key.
void keep_one(Column column, uint pixel, inout bool leaves) {
    uint best = 0u;
    if (column.rule != First) {
        for (uint s = 0u; s < 1u << job.level; ++s) {
            const uint bits = value_of(column.value, pixel, s);
            leaves = leaves || is_nan(bits) || is_subnormal(bits);
            const float key = uintBitsToFloat(bits);
            const float kept = uintBitsToFloat(value_of(column.value, pixel, best));
            if (column.rule == Maximum ? key > kept : key < kept) best = s;
        }
    }
    for (uint c = 0u; c < column.components; ++c) {
        put(column.plane + c, pixel, value_of(column.value + c, pixel, best));
    }
}

void add_counts(Column column, uint pixel) {
    uint sum = 0u;
    for (uint s = 0u; s < 1u << job.level; ++s) sum += value_of(column.value, pixel, s);
    put(column.plane, pixel, sum);
}

void main() {
    if (gl_GlobalInvocationID.x >= job.pixels * job.column_count) return;
    const uint pixel = gl_GlobalInvocationID.x % job.pixels;
    const Column column = job.columns.items[gl_GlobalInvocationID.x / job.pixels];
    bool leaves = false;
    if (column.rule == Moments) {
        merge_moments(column, pixel, leaves);
    } else if (column.rule == Sum) {
        merge_sum(column, pixel, leaves);
    } else if (column.rule == BlockVariance || column.rule == FirstHalf) {
        merge_derived(column, pixel, leaves);
    } else if (column.rule == Count) {
        add_counts(column, pixel);
    } else {
        keep_one(column, pixel, leaves);
    }
    if (leaves) atomicOr(job.planes.items[job.plane_count * job.pixels], 1u);
}
