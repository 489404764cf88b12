// The parts of the wrapper that numbers.cpp does not use: views, results, exceptions, moves, threads, proofs.
#define COLLTRANS_EXCEPTIONS
#include <cmath>
#include <thread>

#include <colltrans.hpp>

namespace ct = colltrans;

static void check(int line, bool holds) {
    if (!holds) {
        std::fprintf(stderr, "line %d: does not hold: %s\n", line, colltrans_error_message());
        std::exit(1);
    }
}
#define CHECK(...) check(__LINE__, (__VA_ARGS__))

// A matrix with the members of Eigen's. Its shape is that of its type, unless this has -1 for any number.
template <int Rows, int Columns, bool ByRows>
struct matrix {
    static constexpr bool IsRowMajor = ByRows;
    static constexpr int RowsAtCompileTime = Rows, ColsAtCompileTime = Columns;
    std::vector<double> numbers;
    long lines = Rows, columns = Columns;
    const double *data() const { return numbers.data(); }
    long rows() const { return lines; }
    long cols() const { return columns; }
};

// A block of a larger matrix, with the strides of Eigen's.
template <int Rows, int Columns, bool ByRows>
struct block : matrix<Rows, Columns, ByRows> {
    long inner = 1, outer = 1;
    long innerStride() const { return inner; }
    long outerStride() const { return outer; }
};

// A transform as Eigen's, whose number of rows is not that of its matrix.
struct isometry {
    ::matrix<4, 4, false> stored;
    const ::matrix<4, 4, false> &matrix() const { return stored; }
    int linear() const { return 0; }
    const double *data() const { return stored.data(); }
    long rows() const { return 3; }
    long cols() const { return 4; }
};

struct point {
    double x, y, z;
};

static void views() {
    const std::vector<double> flat = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const std::vector<point> structs = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const std::vector<double> transposed = {0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const matrix<3, 4, false> by_columns{flat};
    const matrix<4, 3, true> by_rows{flat};
    const matrix<4, 3, false> copied{transposed};
    const std::array<std::array<double, 3>, 4> arrays = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (const ct::points &of : {ct::points(flat), ct::points(structs), ct::points(by_columns), ct::points(by_rows),
                                 ct::points(copied), ct::points(arrays)}) {
        CHECK(of.size() == 4);
        for (std::size_t k = 0; k < 12; ++k) CHECK(of.data()[k] == flat[k]);
        CHECK(ct::body::convex(of)->info()->vertex_count == 4);
    }
    CHECK(ct::points(flat).data() == flat.data());
    CHECK(ct::points(by_columns).data() == by_columns.data());
    const std::vector<double> odd = {1, 2};
    CHECK(ct::points(odd).size() == 0 && !ct::body::convex(odd));
    CHECK(ct::body::convex(odd).error().status == COLLTRANS_INVALID_BODY);

    const matrix<3, 1, false> column{{1, 2, 3}};
    CHECK(ct::vector(column).data()[2] == 3 && std::isnan(ct::vector(odd).data()[0]));
    const matrix<4, 4, false> full{{0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}};
    const matrix<4, 4, true> full_by_rows{{0, -1, 0, 5, 1, 0, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1}};
    const matrix<3, 4, false> affine{{0, 1, 0, -1, 0, 0, 0, 0, 1, 5, 6, 7}};
    for (const ct::pose &pose : {*ct::pose::from_matrix(full), *ct::pose::from_matrix(full_by_rows),
                                 *ct::pose::from_matrix(affine)}) {
        CHECK(pose.rotation[1] == 1 && pose.rotation[3] == -1 && pose.rotation[8] == 1);
        CHECK(pose.translation[0] == 5 && pose.translation[2] == 7);
    }
    CHECK(ct::pose::from_matrix(column).error().message.find("matrix: ") == 0);
    const isometry transform{full};
    CHECK(ct::pose::from_matrix(transform)->rotation[1] == 1 && ct::pose::from_matrix(transform)->translation[1] == 6);
}

// Blocks of larger matrices: their numbers are not contiguous.
static void blocks() {
    const std::vector<double> flat = {1, 2, 3, 4, 5, 6};
    const std::vector<double> high = {1, 2, 3, 9, 4, 5, 6, 9}, wide = {1, 4, 9, 2, 5, 9, 3, 6, 9};
    const block<3, -1, false> top_rows{{high, 3, 2}, 1, 4};
    const block<-1, 3, true> left_columns{{high, 2, 3}, 1, 4};
    const block<-1, 3, false> upper_rows{{wide, 2, 3}, 1, 3};
    const block<-1, -1, true> left_of_wide{{wide, 3, 2}, 1, 3};
    for (const ct::points &of :
         {ct::points(top_rows), ct::points(left_columns), ct::points(upper_rows), ct::points(left_of_wide)}) {
        CHECK(of.size() == 2);
        for (std::size_t k = 0; k < 6; ++k) CHECK(of.data()[k] == flat[k]);
    }
    // A row of a matrix by columns, and a column of a matrix by rows.
    const block<1, 3, true> row{{high, 1, 3}, 2, 1};
    const block<3, 1, false> column{{high, 3, 1}, 3, 1};
    CHECK(ct::vector(row).data()[0] == 1 && ct::vector(row).data()[1] == 3 && ct::vector(row).data()[2] == 4);
    CHECK(ct::vector(column).data()[1] == 9 && ct::vector(column).data()[2] == 6);
    // Of three points, the type states whether they are rows or columns.
    const std::vector<double> nine = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    const matrix<-1, 3, false> points_in_rows{nine, 3, 3};
    const matrix<3, -1, true> points_in_columns{nine, 3, 3};
    const matrix<-1, -1, false> by_columns{nine, 3, 3};
    const matrix<-1, -1, true> by_rows{nine, 3, 3};
    CHECK(ct::points(points_in_rows).data()[1] == 4 && ct::points(points_in_columns).data()[1] == 4);
    CHECK(ct::points(by_columns).data() == by_columns.data() && ct::points(by_rows).data() == by_rows.data());
    const block<4, 4, false> pose{{{0, 1, 0, 0, 8, -1, 0, 0, 0, 8, 0, 0, 1, 0, 8, 5, 6, 7, 1}, 4, 4}, 1, 5};
    CHECK(ct::pose::from_matrix(pose)->translation[0] == 5 && ct::pose::from_matrix(pose)->rotation[1] == 1);
}

static void results() {
    ct::body cube = *ct::body::cuboid({0, 0, 0}, {1, 1, 1});
    static_assert(!std::is_copy_constructible_v<ct::body> && std::is_nothrow_move_constructible_v<ct::body>);
    const ct::body moved = std::move(cube);
    CHECK(cube.get() == nullptr && moved.get() != nullptr);
    CHECK(ct::distance(cube, {}, moved, {}).error().status == COLLTRANS_NULL_ARGUMENT);
    const ct::body copy = *moved.clone();
    CHECK(copy.info()->volume == 1);
    const auto failure = ct::body::cuboid({0, 0, 0}, {1, 1, NAN});
    CHECK(!failure && !failure.has_value());
    // The value of this result would be mistaken for the result.
    static_assert(!std::is_constructible_v<bool, ct::result<bool>> && std::is_constructible_v<bool, ct::result<int>>);
    CHECK(*ct::intersects(moved, {}, copy, {}) && !*ct::intersects(moved, {}, copy, ct::pose::from_translation({3, 0, 0})));
    // The value of a temporary result is kept.
    const auto &kept = *ct::body::cuboid({0, 0, 0}, {1, 1, 2});
    CHECK(kept.info()->volume == 2);
    bool thrown = false;
    try {
        (void)failure.value();
    } catch (const ct::exception &caught) {
        thrown = caught.status() == COLLTRANS_INVALID_BODY && std::string(caught.what()).find("low, high") == 0;
    }
    CHECK(thrown);
    const auto found = ct::distance(moved, {}, copy, ct::pose::from_translation({3, 0, 0}));
    CHECK(found.has_value() && found.error().status == COLLTRANS_OK && found->lower <= 2 && 2 <= found->upper);
    CHECK(ct::is_compatible());
}

static void meshes() {
    const std::vector<double> corners = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1};
    const std::vector<std::uint32_t> quads = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    const std::vector<std::uint32_t> sizes(6, 4);
    std::vector<std::uint32_t> triangles;
    for (std::size_t k = 0; k < quads.size(); k += 4) {
        for (const std::size_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) triangles.push_back(quads[k + corner]);
    }
    CHECK(ct::body::solid(corners, quads, sizes)->info()->face_count == 12);
    CHECK(ct::body::solid(corners, triangles)->info()->is_closed == 1);
    CHECK(ct::body::convex_mesh(corners, triangles)->info()->face_count == 6);
    const ct::view<std::uint32_t> open_quads(quads.data(), 20), open_sizes(sizes.data(), 5);
    CHECK(ct::body::solid(corners, open_quads, open_sizes).error().status == COLLTRANS_INVALID_BODY);
    CHECK(ct::body::solid(corners, open_quads, open_sizes, true)->info()->is_closed == 0);
    CHECK(ct::body::convex_mesh(corners, quads, sizes)->info()->volume == 1);
    // Indices that do not fit their sizes are not read.
    for (const auto &made : {ct::body::solid(corners, open_quads, sizes), ct::body::convex_mesh(corners, open_quads, sizes),
                             ct::body::solid(corners, quads, open_sizes, true)}) {
        CHECK(made.error().status == COLLTRANS_INVALID_ARGUMENT && made.error().message.find("sizes: ") == 0);
    }
    triangles.pop_back();
    for (const auto &made : {ct::body::solid(corners, triangles, true), ct::body::convex_mesh(corners, triangles)}) {
        CHECK(made.error().status == COLLTRANS_INVALID_ARGUMENT && made.error().message.find("triangles: ") == 0);
    }
}

static bool equal(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

// Rows that share no data have the bits of single calls.
static void tables() {
    const ct::body part = *ct::body::cuboid({0, 0, 0}, {1, 2, 3}), table = *ct::body::cuboid({-5, -5, -1}, {5, 5, 0});
    std::vector<ct::pose> poses;
    for (int k = 0; k < 60; ++k) {
        poses.push_back(*ct::pose::from_quaternion({std::sin(0.1 * k), 0, 0, std::cos(0.1 * k)}, {0.2 * k - 6, 0, 4}));
    }
    const std::vector<double> down = {0, 0.25, -1};
    ct::rows rows;
    rows.moving_poses = poses;
    rows.directions = down;
    std::vector<double> translation(poses.size()), lower(poses.size()), exit(poses.size()), points(3 * poses.size());
    std::vector<ct::feature> features(poses.size());
    ct::cast_columns columns{};
    columns.translation = translation.data();
    columns.translation_lower = lower.data();
    columns.exit = exit.data();
    columns.point_on_moving = points.data();
    columns.moving_feature = features.data();
    ct::cast_options options{};
    options.features = 1;
    for (const bool ranges : {false, true}) {
        *(ranges ? ct::contact_range_many : ct::first_contact_many)(part, table, rows, columns, options);
        for (std::size_t k = 0; k < poses.size(); ++k) {
            const auto one = *(ranges ? ct::contact_range(part, poses[k], table, {}, down, options)
                                      : ct::first_contact(part, poses[k], table, {}, down, options));
            CHECK(equal(one.translation, translation[k]) && equal(one.translation_lower, lower[k]));
            CHECK(equal(one.exit, exit[k]) && equal(one.point_on_moving[2], points[3 * k + 2]));
            CHECK(one.moving_feature.kind == features[k].kind);
            CHECK(one.moving_feature.vertices[0] == features[k].vertices[0]);
        }
    }
}

// An empty table has no rows, whatever the other tables have.
static void empty_tables() {
    const ct::body cube = *ct::body::cuboid({0, 0, 0}, {1, 1, 1});
    std::vector<ct::pose> poses(2);
    const std::vector<double> down = {0, 0, -1}, odd = {0, -1};
    double distance[2] = {-7, -7};
    ct::cast_columns columns{};
    columns.distance = distance;
    ct::rows rows;
    rows.directions = down;
    CHECK(rows.size() == 1);
    rows.moving_poses = poses;
    CHECK(rows.size() == 2);
    poses.clear();
    rows.moving_poses = poses;
    CHECK(rows.size() == 0 && ct::clearance_many(cube, cube, rows, columns) && distance[0] == -7);
    rows = {};
    rows.directions = down;
    rows.count = 0;
    CHECK(ct::clearance_many(cube, cube, rows, columns) && distance[0] == -7);
    rows.count = 2;
    CHECK(ct::clearance_many(cube, cube, rows, columns) && std::isnan(distance[1]));
    for (const ct::points &directions : {ct::points(), ct::points(odd)}) {
        rows = {};
        rows.directions = directions;
        const auto failed = ct::clearance_many(cube, cube, rows, columns);
        CHECK(failed.error().status == COLLTRANS_INVALID_ARGUMENT && failed.error().message.find("rows.directions: ") == 0);
    }
}

static void proofs() {
    const ct::body cube = *ct::body::cuboid({0, 0, 0}, {1, 1, 1});
    const ct::body solid = *ct::body::pieces({&cube, &cube});
    const ct::pose above = ct::pose::from_translation({0.25, 0, 3});
    const ct::vector down{0, 0, -1};
    const ct::motion way = *ct::motion::translation(above, {0, 0, -4}), rest = *ct::motion::rest({});
    const ct::motion turn = *ct::motion::screw(above, {0, 0, 0}, {0, 0, 1}, 1.0);
    const ct::motion flight = *ct::motion::free_flight(above, {0, 0, 3}, {0, 0, -5}, {0, 1, 0});
    CHECK(std::fabs(way.pose_at(0.5)->translation[2] - 1) < 1e-12);
    CHECK(ct::first_contact(cube, turn, cube, rest)->outcome == COLLTRANS_FREE);
    CHECK(ct::first_contact(cube, flight, cube, rest)->outcome == COLLTRANS_CONTACT);
    ct::scene scene = *ct::scene::make();
    const auto id = *scene.insert(solid, {});
    CHECK(scene.set_pose(id, {}) && scene.size() == 1 && scene.clearance(cube, above, down)->answer.distance > 1.9);
    const std::vector<ct::result<ct::proof>> all = {
        ct::first_contact_proof(cube, above, cube, {}, down),
        ct::clearance_proof(cube, above, cube, {}, down),
        ct::clearance_proof(solid, above, cube, {}, down),
        ct::distance_proof(cube, above, cube, {}),
        ct::distance_proof(cube, above, solid, {}),
        ct::within_proof(cube, above, cube, {}, 1.0),
        ct::within_proof(solid, above, cube, {}, 1.0),
        ct::depth_proof(cube, {}, cube, {}),
        ct::depth_proof(solid, {}, cube, {}),
        ct::common_part_proof(cube, {}, cube, {}),
        ct::common_part_proof(solid, {}, cube, {}),
        ct::first_contact_proof(cube, way, cube, rest),
        ct::first_contact_proof(solid, way, cube, rest),
        scene.nearest_proof(cube, above),
        scene.clearance_proof(cube, above, down),
    };
    for (const auto &proof : all) {
        CHECK(proof.has_value());
        const auto statement = ct::check_proof(*proof);
        CHECK(statement.has_value() && !statement->empty());
    }
    CHECK(scene.remove(id) && !scene.remove(id) && scene.size() == 0);
    CHECK(!scene.nearest_proof(cube, above));
    CHECK(ct::check_proof("nonsense").error().status == COLLTRANS_NOT_PROVEN);
}

// Bodies and scenes are shared, the text of an error belongs to its thread.
static void threads() {
    const ct::body cube = *ct::body::cuboid({0, 0, 0}, {1, 1, 1});
    ct::scene scene = *ct::scene::make();
    *scene.insert(cube, {});
    std::vector<std::thread> all;
    std::array<bool, 4> right{};
    for (std::size_t k = 0; k < right.size(); ++k) {
        all.emplace_back([&, k] {
            ct::tracker tracker = *ct::tracker::make();
            bool holds = true;
            for (int step = 0; step < 200; ++step) {
                const double height = 2 + 0.01 * step;
                const ct::pose above = ct::pose::from_translation({0.25, 0.25, height});
                const ct::vector down{0, 0, -1};
                const auto tracked = tracker.first_contact(cube, above, cube, {}, down);
                holds &= std::fabs(tracked->translation - height + 1) < 1e-12;
                holds &= std::fabs(scene.nearest(cube, above)->answer.upper - height + 1) < 1e-12;
                const double direction = static_cast<double>(k) * 0.0;
                const auto failed = ct::first_contact(cube, above, cube, {}, {direction, 0, 0});
                holds &= failed.error().message.find("the direction") == 0;
            }
            right[k] = holds;
        });
    }
    for (auto &thread : all) thread.join();
    for (const bool holds : right) CHECK(holds);
}

int main() {
    views();
    blocks();
    results();
    meshes();
    tables();
    empty_tables();
    proofs();
    threads();
}
