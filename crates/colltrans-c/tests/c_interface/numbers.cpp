// Answers of the C++ wrapper, the same as those of numbers.c.
#include <cstring>

#include <colltrans.hpp>

#include "numbers.h"

namespace ct = colltrans;

static ct::body next_body() {
    std::vector<std::array<double, 3>> points(POINTS);
    for (auto &point : points) next_vector(point.data());
    return *ct::body::convex(points);
}

static ct::pose placed(double reach) {
    std::array<double, 4> xyzw;
    std::array<double, 3> translation;
    next_pose(reach, xyzw.data(), translation.data());
    return *ct::pose::from_quaternion(xyzw, translation);
}

static std::array<double, 3> next_direction() {
    std::array<double, 3> direction;
    next_vector(direction.data());
    return direction;
}

static void put(const char *name, const ct::cast_answer &of) { put_cast(name, &of); }
static void put(const char *name, const ct::distance_answer &of) { put_distance(name, &of); }
static void put(const char *name, const ct::depth_answer &of) { put_depth(name, &of); }
static void put(const char *name, const ct::motion_answer &of) { put_motion(name, &of); }

static void pairs() {
    ct::tracker tracker = *ct::tracker::make();
    ct::cast_options options{};
    options.features = 1;
    for (int k = 0; k < CASES; ++k) {
        const ct::body p = next_body(), q = next_body();
        const ct::pose a = placed(2.5), b = placed(2.5);
        const auto direction = next_direction();
        const ct::body solid = *ct::body::pieces({&p, &q}), ball = *p.rounded(0.125);
        put("first_contact", *ct::first_contact(p, a, q, b, direction, options));
        put("contact_range", *ct::contact_range(p, a, q, b, direction, options));
        put("clearance", *ct::clearance(p, a, q, b, direction, options));
        options.min_gap = 0.0625;
        put("clearance_gap", *ct::clearance(ball, a, q, b, direction, options));
        options.min_gap = 0;
        put("clearance_solid", *ct::clearance(solid, a, q, b, direction));
        *tracker.first_contact(p, a, q, b, direction, options);
        put("tracked", *tracker.first_contact(p, b, q, a, direction, options));
        put("tracked_distance", *tracker.distance(p, a, q, b));
        std::printf("intersects %d\n", int(*ct::intersects(p, a, q, b)));
        put("distance", *ct::distance(p, a, q, b));
        put("distance_solid", *ct::distance(solid, a, q, b));
        const auto bounds = *ct::distance_bounds(ball, a, q, b);
        std::printf("bounds");
        put(bounds[0]);
        put(bounds[1]);
        std::printf("\n");
        put("within", *ct::within(p, a, q, b, 1.0));
        put("depth", *ct::depth(p, {}, q, b));
        put("depth_solid", *ct::depth(solid, {}, q, b));
    }
}

static void motions() {
    for (int k = 0; k < CASES; ++k) {
        const ct::body p = next_body(), q = next_body();
        const std::vector<ct::pose> poses = {placed(2.5), placed(2.5)};
        const ct::body solid = *ct::body::pieces({&p});
        const ct::motion way = *ct::motion::through(poses), rest = *ct::motion::rest({});
        put("motion", *ct::first_contact(p, way, q, rest));
        put("motion_clearance", *ct::clearance(p, way, q, rest));
        if (k % 8 == 0) put("motion_solid", *ct::first_contact(solid, way, q, rest));
    }
}

static void scenes() {
    const ct::body hand = next_body();
    ct::scene scene = *ct::scene::make();
    for (int k = 0; k < CASES; ++k) {
        const ct::body body = next_body();
        *scene.insert(body, placed(9));
    }
    for (int k = 0; k < CASES; ++k) {
        const ct::pose pose = placed(9);
        const auto direction = next_direction();
        const std::vector<std::uint64_t> ignored = {3};
        const auto nearest = *scene.nearest(hand, pose, ignored);
        std::printf("%llu ", static_cast<unsigned long long>(nearest.obstacle));
        put("nearest", nearest.answer);
        const auto clearance = *scene.clearance(hand, pose, direction, {}, ignored);
        std::printf("%llu ", static_cast<unsigned long long>(clearance.obstacle));
        put("scene_clearance", clearance.answer);
        const ct::nearby near = *scene.within(hand, pose, 3.0);
        std::printf("scene_within %d %d", int(near.closer.size()), int(near.undecided.size()));
        for (const auto id : near.closer) std::printf(" %llu", static_cast<unsigned long long>(id));
        std::printf("\n");
    }
}

static void many(bool rotates, std::size_t direction_count) {
    const ct::body p = next_body(), q = next_body();
    std::vector<std::array<double, 3>> directions(direction_count);
    for (auto &direction : directions) direction = next_direction();
    std::vector<ct::pose> poses;
    for (std::size_t k = 0; k < ROWS; ++k) {
        poses.push_back(placed(3));
        if (!rotates) std::memcpy(poses[k].rotation, poses[0].rotation, sizeof poses[k].rotation);
    }
    std::vector<double> distances(ROWS), lower(ROWS), normals(3 * ROWS);
    std::vector<ct::outcome> outcomes(ROWS);
    std::vector<ct::status> statuses(ROWS);
    ct::cast_columns columns{};
    columns.status = statuses.data();
    columns.outcome = outcomes.data();
    columns.distance = distances.data();
    columns.normal = normals.data();
    ct::rows rows;
    rows.moving_poses = poses;
    rows.directions = directions;
    rows.threads = 2;
    *ct::clearance_many(p, q, rows, columns);
    for (std::size_t k = 0; k < ROWS; ++k) {
        std::printf("many %d %d", int(statuses[k]), int(outcomes[k]));
        put(distances[k]);
        put_vector(normals.data() + 3 * k);
        std::printf("\n");
    }
    rows.directions = {};
    ct::distance_columns nearest{};
    nearest.lower = lower.data();
    *ct::distance_many(p, q, rows, nearest);
    for (const double bound : lower) {
        std::printf("many_distances");
        put(bound);
        std::printf("\n");
    }
}

int main() {
    pairs();
    motions();
    scenes();
    many(true, 1);
    many(false, 1);
    many(false, ROWS);
}
