/* Answers of the C interface, for numbers.rs. */
#include "numbers.h"

static void ok(colltrans_status status, int line) {
    if (status != COLLTRANS_OK) {
        fprintf(stderr, "line %d: status %d: %s\n", line, (int)status, colltrans_error_message());
        exit(1);
    }
}
#define OK(call) ok((call), __LINE__)

static colltrans_body *next_body(void) {
    double points[3 * POINTS];
    colltrans_body *body = NULL;
    for (int k = 0; k < POINTS; ++k) next_vector(points + 3 * k);
    OK(colltrans_convex_from_points(points, POINTS, &body));
    return body;
}

static colltrans_pose placed(double reach) {
    double xyzw[4], translation[3];
    colltrans_pose pose;
    next_pose(reach, xyzw, translation);
    OK(colltrans_pose_from_quaternion(xyzw, translation, &pose));
    return pose;
}

static void pairs(void) {
    colltrans_tracker *tracker = NULL;
    colltrans_cast_options options;
    memset(&options, 0, sizeof options);
    options.features = 1;
    OK(colltrans_tracker_new(&tracker));
    for (int k = 0; k < CASES; ++k) {
        colltrans_body *p = next_body(), *q = next_body(), *solid = NULL, *ball = NULL;
        const colltrans_body *pieces[2] = {p, q};
        const colltrans_pose a = placed(2.5), b = placed(2.5);
        double direction[3], bounds[2];
        colltrans_cast_answer cast;
        colltrans_distance_answer distance;
        colltrans_depth_answer depth;
        uint32_t meets = 2;
        next_vector(direction);
        OK(colltrans_solid_from_pieces(pieces, 2, &solid));
        OK(colltrans_body_rounded(p, 0.125, &ball));

        OK(colltrans_first_contact(p, &a, q, &b, direction, &options, &cast));
        put_cast("first_contact", &cast);
        OK(colltrans_contact_range(p, &a, q, &b, direction, &options, &cast));
        put_cast("contact_range", &cast);
        OK(colltrans_clearance(p, &a, q, &b, direction, &options, &cast));
        put_cast("clearance", &cast);
        options.min_gap = 0.0625;
        OK(colltrans_clearance(ball, &a, q, &b, direction, &options, &cast));
        put_cast("clearance_gap", &cast);
        options.min_gap = 0;
        OK(colltrans_clearance(solid, &a, q, &b, direction, NULL, &cast));
        put_cast("clearance_solid", &cast);
        OK(colltrans_tracker_first_contact(tracker, p, &a, q, &b, direction, &options, &cast));
        OK(colltrans_tracker_first_contact(tracker, p, &b, q, &a, direction, &options, &cast));
        put_cast("tracked", &cast);
        OK(colltrans_tracker_distance(tracker, p, &a, q, &b, &distance));
        put_distance("tracked_distance", &distance);
        OK(colltrans_intersects(p, &a, q, &b, NULL, &meets));
        printf("intersects %u\n", (unsigned)meets);

        OK(colltrans_distance(p, &a, q, &b, &distance));
        put_distance("distance", &distance);
        OK(colltrans_distance(solid, &a, q, &b, &distance));
        put_distance("distance_solid", &distance);
        OK(colltrans_distance_bounds(ball, &a, q, &b, bounds));
        printf("bounds");
        put(bounds[0]);
        put(bounds[1]);
        printf("\n");
        OK(colltrans_within(p, &a, q, &b, 1.0, &distance));
        put_distance("within", &distance);
        OK(colltrans_depth(p, NULL, q, &b, &depth));
        put_depth("depth", &depth);
        OK(colltrans_depth(solid, NULL, q, &b, &depth));
        put_depth("depth_solid", &depth);
        colltrans_body_free(ball);
        colltrans_body_free(solid);
        colltrans_body_free(q);
        colltrans_body_free(p);
    }
    colltrans_tracker_free(tracker);
}

static void motions(void) {
    for (int k = 0; k < CASES; ++k) {
        colltrans_body *p = next_body(), *q = next_body(), *solid = NULL;
        const colltrans_body *pieces[1] = {p};
        const colltrans_pose poses[2] = {placed(2.5), placed(2.5)};
        colltrans_motion *way = NULL, *rest = NULL;
        colltrans_motion_answer answer;
        OK(colltrans_solid_from_pieces(pieces, 1, &solid));
        OK(colltrans_motion_through_poses(poses, 2, &way));
        OK(colltrans_motion_rest(NULL, &rest));
        OK(colltrans_motion_first_contact(p, way, q, rest, NULL, &answer));
        put_motion("motion", &answer);
        OK(colltrans_motion_clearance(p, way, q, rest, NULL, &answer));
        put_motion("motion_clearance", &answer);
        if (k % 8 == 0) {
            OK(colltrans_motion_first_contact(solid, way, q, rest, NULL, &answer));
            put_motion("motion_solid", &answer);
        }
        colltrans_motion_free(rest);
        colltrans_motion_free(way);
        colltrans_body_free(solid);
        colltrans_body_free(q);
        colltrans_body_free(p);
    }
}

static void scenes(void) {
    colltrans_scene *scene = NULL;
    colltrans_body *hand = next_body();
    uint64_t id = 0;
    OK(colltrans_scene_new(&scene));
    for (int k = 0; k < CASES; ++k) {
        colltrans_body *body = next_body();
        const colltrans_pose pose = placed(9);
        OK(colltrans_scene_insert(scene, body, &pose, &id));
        colltrans_body_free(body);
    }
    for (int k = 0; k < CASES; ++k) {
        const colltrans_pose pose = placed(9);
        const uint64_t ignored[1] = {3};
        uint64_t near[CASES];
        size_t closer = 0, undecided = 0;
        double direction[3];
        colltrans_distance_answer distance;
        colltrans_cast_answer cast;
        next_vector(direction);
        OK(colltrans_scene_nearest(scene, hand, &pose, ignored, 1, &id, &distance));
        printf("%llu ", (unsigned long long)id);
        put_distance("nearest", &distance);
        OK(colltrans_scene_clearance(scene, hand, &pose, direction, NULL, ignored, 1, &id, &cast));
        printf("%llu ", (unsigned long long)id);
        put_cast("scene_clearance", &cast);
        OK(colltrans_scene_within(scene, hand, &pose, 3.0, NULL, 0, near, CASES, &closer, &undecided));
        printf("scene_within %d %d", (int)closer, (int)undecided);
        for (size_t at = 0; at < closer; ++at) printf(" %llu", (unsigned long long)near[at]);
        printf("\n");
    }
    colltrans_scene_free(scene);
    colltrans_body_free(hand);
}

static void many(int rotates, size_t direction_count) {
    static colltrans_pose poses[ROWS];
    static double directions[3 * ROWS], distances[ROWS], lower[ROWS], normals[3 * ROWS];
    static colltrans_outcome outcomes[ROWS];
    static colltrans_status statuses[ROWS];
    colltrans_body *p = next_body(), *q = next_body();
    colltrans_rows rows;
    colltrans_cast_columns columns;
    colltrans_distance_columns nearest;
    memset(&rows, 0, sizeof rows);
    memset(&columns, 0, sizeof columns);
    memset(&nearest, 0, sizeof nearest);
    for (size_t k = 0; k < direction_count; ++k) next_vector(directions + 3 * k);
    for (int k = 0; k < ROWS; ++k) {
        poses[k] = placed(3);
        if (!rotates) memcpy(poses[k].rotation, poses[0].rotation, sizeof poses[k].rotation);
    }
    rows.count = ROWS;
    rows.moving_poses = poses;
    rows.moving_pose_count = ROWS;
    rows.directions = directions;
    rows.direction_count = direction_count;
    rows.threads = 2;
    columns.status = statuses;
    columns.outcome = outcomes;
    columns.distance = distances;
    columns.normal = normals;
    OK(colltrans_clearance_many(p, q, &rows, NULL, &columns));
    for (int k = 0; k < ROWS; ++k) {
        printf("many %d %d", (int)statuses[k], (int)outcomes[k]);
        put(distances[k]);
        put_vector(normals + 3 * k);
        printf("\n");
    }
    rows.direction_count = 0;
    nearest.lower = lower;
    OK(colltrans_distance_many(p, q, &rows, &nearest));
    for (int k = 0; k < ROWS; ++k) {
        printf("many_distances");
        put(lower[k]);
        printf("\n");
    }
    colltrans_body_free(q);
    colltrans_body_free(p);
}

int main(void) {
    pairs();
    motions();
    scenes();
    many(1, 1);
    many(0, 1);
    many(0, ROWS);
    return 0;
}
