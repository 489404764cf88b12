/* Invalid arguments: each is an error that names the argument, and no output is written. */
#include <colltrans.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void expect(int line, colltrans_status status, colltrans_status expected, const char *text) {
    if (status != expected || strstr(colltrans_error_message(), text) == NULL) {
        fprintf(stderr, "line %d: status %d, expected %d with '%s': %s\n", line, (int)status, (int)expected, text,
                colltrans_error_message());
        exit(1);
    }
}
#define EXPECT(call, status, text) expect(__LINE__, (call), (status), (text))
#define OK(call) expect(__LINE__, (call), COLLTRANS_OK, "")

static void check(int line, int holds) {
    if (!holds) {
        fprintf(stderr, "line %d: does not hold\n", line);
        exit(1);
    }
}
#define CHECK(holds) check(__LINE__, (holds))

int main(void) {
    const double low[] = {0, 0, 0}, high[] = {1, 1, 1}, down[] = {0, 0, -1}, none[] = {0, 0, 0};
    const double bad[] = {0, 0, 0, 1, NAN, 0, 0, 0, 1};
    const uint32_t open[] = {0, 1, 2};
    const colltrans_pose world = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    colltrans_pose turned = world, pose = world;
    colltrans_cast_options options;
    colltrans_cast_answer answer;
    colltrans_distance_answer distance;
    colltrans_depth_answer depth;
    colltrans_motion_answer motion_answer;
    colltrans_body *cube = NULL, *solid = NULL, *body = NULL;
    colltrans_motion *rest = NULL, *motion = NULL;
    colltrans_scene *scene = NULL;
    colltrans_tracker *tracker = NULL;
    colltrans_rows rows;
    colltrans_cast_columns columns;
    colltrans_body_properties info;
    uint64_t id = 0, ids[1];
    size_t closer, undecided;
    const char *text = NULL;
    union {
        double aligned[8];
        char bytes[64];
    } room;
    memset(&room, 0, sizeof room);
    memset(&options, 0, sizeof options);
    memset(&answer, 7, sizeof answer);
    memset(&rows, 0, sizeof rows);
    memset(&columns, 0, sizeof columns);

    CHECK(colltrans_abi() == COLLTRANS_ABI);
    CHECK(strlen(colltrans_version()) >= 5);
    CHECK(strlen(colltrans_error_message()) == 0);

    /* Bodies. */
    EXPECT(colltrans_convex_from_points(NULL, 3, &body), COLLTRANS_NULL_ARGUMENT, "points: the pointer is null");
    EXPECT(colltrans_convex_from_points(NULL, 0, &body), COLLTRANS_INVALID_BODY, "points: no points given");
    EXPECT(colltrans_convex_from_points(bad, 3, &body), COLLTRANS_INVALID_BODY, "points: point 1 is not finite");
    EXPECT(colltrans_convex_from_points(low, SIZE_MAX / 8, &body), COLLTRANS_INVALID_ARGUMENT, "points: ");
    EXPECT(colltrans_convex_from_points(low, 1, NULL), COLLTRANS_NULL_ARGUMENT, "body: the pointer is null");
    EXPECT(colltrans_convex_from_points((const double *)(const void *)(room.bytes + 1), 1, &body),
           COLLTRANS_MISALIGNED_ARGUMENT, "points: the pointer is not aligned to 8 bytes");
    EXPECT(colltrans_convex_cuboid(low, NULL, &body), COLLTRANS_NULL_ARGUMENT, "high: ");
    EXPECT(colltrans_convex_cuboid(bad + 3, high, &body), COLLTRANS_INVALID_BODY, "low, high: ");
    EXPECT(colltrans_convex_from_mesh(bad + 5, 1, open, NULL, 1, 0, &body), COLLTRANS_INVALID_BODY,
           "vertices, indices: ");
    EXPECT(colltrans_solid_from_mesh(low, 1, NULL, NULL, 1, 0, &body), COLLTRANS_NULL_ARGUMENT, "indices: ");
    EXPECT(colltrans_solid_from_mesh(low, 1, open, NULL, 1, 0, &body), COLLTRANS_INVALID_BODY, "vertices, indices: ");
    EXPECT(colltrans_solid_from_pieces(NULL, 1, &body), COLLTRANS_NULL_ARGUMENT, "pieces: ");
    CHECK(body == NULL);
    OK(colltrans_convex_cuboid(low, high, &cube));
    {
        const colltrans_body *pieces[2];
        pieces[0] = cube;
        pieces[1] = NULL;
        EXPECT(colltrans_solid_from_pieces(pieces, 2, &body), COLLTRANS_NULL_ARGUMENT, "pieces[1]: ");
        EXPECT(colltrans_solid_from_pieces(pieces, 0, &body), COLLTRANS_INVALID_BODY, "pieces: ");
        OK(colltrans_solid_from_pieces(pieces, 1, &solid));
    }
    {
        /* A rounded body is not a piece, whether it is a union or not. */
        const colltrans_body *pieces[2];
        colltrans_body *rounded[2] = {NULL, NULL};
        pieces[1] = cube;
        OK(colltrans_body_rounded(solid, 0.5, &rounded[0]));
        OK(colltrans_body_rounded(cube, 0.5, &rounded[1]));
        for (int k = 0; k < 2; ++k) {
            pieces[0] = rounded[k];
            EXPECT(colltrans_solid_from_pieces(pieces, 2, &body), COLLTRANS_INVALID_BODY, "pieces: ");
            colltrans_body_free(rounded[k]);
        }
        CHECK(body == NULL);
    }
    EXPECT(colltrans_body_rounded(cube, -1, &body), COLLTRANS_INVALID_BODY, "radius");
    EXPECT(colltrans_body_rounded(cube, NAN, &body), COLLTRANS_INVALID_BODY, "radius");
    EXPECT(colltrans_body_info(NULL, &info), COLLTRANS_NULL_ARGUMENT, "body: ");
    OK(colltrans_body_info(cube, &info));
    CHECK(info.is_convex == 1 && info.vertex_count == 8 && info.face_count == 6 && info.volume == 1);
    OK(colltrans_body_info(solid, &info));
    CHECK(info.is_convex == 0 && info.is_closed == 1 && info.face_count == 12 && fabs(info.volume - 1) < 1e-12);
    OK(colltrans_body_clone(cube, &body));
    colltrans_body_free(body);
    body = NULL;

    /* Poses. */
    EXPECT(colltrans_pose_from_quaternion(bad + 2, low, &pose), COLLTRANS_INVALID_ARGUMENT, "xyzw, translation: ");
    EXPECT(colltrans_pose_from_quaternion(bad, bad + 4, &pose), COLLTRANS_INVALID_ARGUMENT, "xyzw, translation: ");
    EXPECT(colltrans_pose_from_matrix(NULL, &pose), COLLTRANS_NULL_ARGUMENT, "matrix: ");
    {
        double matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
        OK(colltrans_pose_from_matrix(matrix, &pose));
        CHECK(pose.rotation[0] == 1 && pose.translation[2] == 7);
        matrix[3] = 1;
        EXPECT(colltrans_pose_from_matrix(matrix, &pose), COLLTRANS_INVALID_ARGUMENT, "matrix: the last row is ");
        matrix[3] = 0;
        matrix[0] = -1;
        EXPECT(colltrans_pose_from_matrix(matrix, &pose), COLLTRANS_INVALID_ARGUMENT, "matrix: ");
    }
    turned.rotation[0] = NAN;

    /* Casts. */
    EXPECT(colltrans_first_contact(NULL, NULL, cube, NULL, down, NULL, &answer), COLLTRANS_NULL_ARGUMENT, "moving: ");
    EXPECT(colltrans_first_contact(cube, NULL, NULL, NULL, down, NULL, &answer), COLLTRANS_NULL_ARGUMENT, "fixed: ");
    EXPECT(colltrans_first_contact(cube, &turned, cube, NULL, down, NULL, &answer), COLLTRANS_INVALID_ARGUMENT,
           "moving_pose: ");
    EXPECT(colltrans_clearance(cube, NULL, cube, &turned, down, NULL, &answer), COLLTRANS_INVALID_ARGUMENT,
           "fixed_pose: ");
    EXPECT(colltrans_contact_range(cube, NULL, cube, NULL, NULL, NULL, &answer), COLLTRANS_NULL_ARGUMENT,
           "direction: ");
    EXPECT(colltrans_first_contact(cube, NULL, cube, NULL, none, NULL, &answer), COLLTRANS_INVALID_ARGUMENT,
           "the direction [0.0, 0.0, 0.0] is zero");
    EXPECT(colltrans_first_contact(cube, NULL, cube, NULL, bad + 3, NULL, &answer), COLLTRANS_INVALID_ARGUMENT,
           "the direction [1.0, NaN, 0.0]");
    EXPECT(colltrans_first_contact(cube, NULL, cube, NULL, down, NULL, NULL), COLLTRANS_NULL_ARGUMENT, "answer: ");
    EXPECT(colltrans_first_contact(cube, (const colltrans_pose *)(const void *)(room.bytes + 4), cube, NULL, down, NULL,
                                   &answer),
           COLLTRANS_MISALIGNED_ARGUMENT, "moving_pose: the pointer is not aligned");
    options.min_gap = NAN;
    EXPECT(colltrans_first_contact(cube, NULL, cube, NULL, down, &options, &answer), COLLTRANS_INVALID_ARGUMENT,
           "the minimum gap NaN");
    EXPECT(colltrans_first_contact(solid, NULL, cube, NULL, down, &options, &answer), COLLTRANS_INVALID_ARGUMENT,
           "the minimum gap NaN");
    options.min_gap = 0;
    options.graze_tolerance = -1;
    EXPECT(colltrans_first_contact(cube, NULL, cube, NULL, down, &options, &answer), COLLTRANS_INVALID_ARGUMENT,
           "the graze tolerance -1");
    EXPECT(colltrans_first_contact(solid, NULL, cube, NULL, down, &options, &answer), COLLTRANS_INVALID_ARGUMENT,
           "options.graze_tolerance: a cast of solids has no such option");
    options.graze_tolerance = 0;
    options.solver = 9;
    EXPECT(colltrans_first_contact(cube, NULL, cube, NULL, down, &options, &answer), COLLTRANS_INVALID_ARGUMENT,
           "options.solver: unknown solver 9");
    options.solver = 0;
    options.has_tolerance = 1;
    options.tolerance = 3;
    EXPECT(colltrans_first_contact(cube, NULL, cube, NULL, down, &options, &answer), COLLTRANS_INVALID_ARGUMENT,
           "options.tolerance: ");
    EXPECT(colltrans_clearance(solid, NULL, cube, NULL, down, &options, &answer), COLLTRANS_INVALID_ARGUMENT,
           "leaves nothing of the moving body");
    options.tolerance = NAN;
    EXPECT(colltrans_clearance(solid, NULL, cube, NULL, down, &options, &answer), COLLTRANS_INVALID_ARGUMENT,
           "options.tolerance: ");
    options.has_tolerance = 0;
    options.has_before = 1;
    for (int k = 0; k < 2; ++k) {
        options.before = k == 0 ? -1 : NAN;
        EXPECT(colltrans_clearance(solid, &pose, cube, NULL, down, &options, &answer), COLLTRANS_INVALID_ARGUMENT,
               "options.before: ");
    }
    EXPECT(colltrans_clearance(cube, &pose, cube, NULL, down, &options, &answer), COLLTRANS_INVALID_ARGUMENT,
           "options.before: a cast of convex bodies has no such option");
    options.has_before = 0;
    {
        unsigned char untouched[sizeof answer];
        memset(untouched, 7, sizeof untouched);
        CHECK(memcmp(untouched, &answer, sizeof answer) == 0);
    }

    /* A clearance is not larger than the end of the query. */
    {
        colltrans_pose above = world;
        double distances[1];
        colltrans_outcome outcomes[1];
        above.translation[2] = 3;
        options.has_before = 1;
        options.before = 1;
        OK(colltrans_clearance(solid, &above, cube, NULL, down, &options, &answer));
        CHECK(answer.outcome == COLLTRANS_FREE && answer.distance == 1 && isnan(answer.translation));
        rows.count = 1;
        rows.moving_poses = &above;
        rows.moving_pose_count = 1;
        rows.directions = down;
        rows.direction_count = 1;
        columns.distance = distances;
        columns.outcome = outcomes;
        OK(colltrans_clearance_many(solid, cube, &rows, &options, &columns));
        CHECK(outcomes[0] == COLLTRANS_FREE && distances[0] == 1);
        memset(&rows, 0, sizeof rows);
        memset(&columns, 0, sizeof columns);
        options.before = 2.5;
        OK(colltrans_clearance(solid, &above, cube, NULL, down, &options, &answer));
        CHECK(answer.outcome == COLLTRANS_BLOCKED && answer.translation == 2);
        CHECK(answer.distance == answer.translation_lower && answer.distance > 1.999);
        options.before = INFINITY;
        OK(colltrans_clearance(solid, &above, cube, NULL, high, &options, &answer));
        CHECK(answer.outcome == COLLTRANS_FREE && isinf(answer.distance));
        options.has_before = 0;
        options.before = 0;
    }

    /* Distances. */
    EXPECT(colltrans_distance(cube, NULL, cube, NULL, NULL), COLLTRANS_NULL_ARGUMENT, "answer: ");
    EXPECT(colltrans_within(cube, NULL, cube, NULL, -1, &distance), COLLTRANS_INVALID_ARGUMENT, "the length -1");
    EXPECT(colltrans_depth(cube, &turned, cube, NULL, &depth), COLLTRANS_INVALID_ARGUMENT, "moving_pose: ");
    EXPECT(colltrans_distance_bounds(cube, NULL, cube, NULL, NULL), COLLTRANS_NULL_ARGUMENT, "bounds: ");

    /* Trackers. */
    EXPECT(colltrans_tracker_new(NULL), COLLTRANS_NULL_ARGUMENT, "tracker: ");
    OK(colltrans_tracker_new(&tracker));
    EXPECT(colltrans_tracker_clearance(NULL, cube, NULL, cube, NULL, down, NULL, &answer), COLLTRANS_NULL_ARGUMENT,
           "tracker: ");
    EXPECT(colltrans_tracker_clearance(tracker, solid, NULL, cube, NULL, down, NULL, &answer),
           COLLTRANS_INVALID_ARGUMENT, "trackers accept two convex bodies");
    OK(colltrans_tracker_clearance(tracker, cube, NULL, cube, NULL, down, NULL, &answer));
    CHECK(answer.outcome == COLLTRANS_OVERLAPPING && isnan(answer.distance));
    OK(colltrans_tracker_reset(tracker));

    /* Motions. */
    EXPECT(colltrans_motion_through_poses(&world, 0, &motion), COLLTRANS_INVALID_ARGUMENT, "poses: ");
    EXPECT(colltrans_motion_through_poses(&turned, 1, &motion), COLLTRANS_INVALID_ARGUMENT, "poses[0]: ");
    EXPECT(colltrans_motion_translation(NULL, bad + 3, &motion), COLLTRANS_INVALID_ARGUMENT, "displacement: ");
    EXPECT(colltrans_motion_screw(NULL, low, none, 1, 0, &motion), COLLTRANS_INVALID_ARGUMENT, "axis");
    EXPECT(colltrans_motion_free_flight(NULL, low, low, NULL, &motion), COLLTRANS_NULL_ARGUMENT, "angular_velocity: ");
    CHECK(motion == NULL);
    OK(colltrans_motion_rest(NULL, &rest));
    EXPECT(colltrans_motion_pose_at(rest, 2, &pose), COLLTRANS_INVALID_ARGUMENT, "time: ");
    EXPECT(colltrans_motion_first_contact(cube, NULL, cube, rest, NULL, &motion_answer), COLLTRANS_NULL_ARGUMENT,
           "moving_motion: ");
    options.has_before = 1;
    EXPECT(colltrans_motion_first_contact(cube, rest, cube, rest, &options, &motion_answer),
           COLLTRANS_INVALID_ARGUMENT, "options.before: a motion has no such option");
    options.has_before = 0;

    /* Scenes. */
    OK(colltrans_scene_new(&scene));
    OK(colltrans_scene_nearest(scene, cube, NULL, NULL, 0, &id, &distance));
    CHECK(id == COLLTRANS_NO_OBSTACLE && isinf(distance.upper));
    EXPECT(colltrans_scene_insert(scene, NULL, NULL, &id), COLLTRANS_NULL_ARGUMENT, "body: ");
    OK(colltrans_scene_insert(scene, cube, NULL, &id));
    EXPECT(colltrans_scene_set_pose(scene, id + 1, NULL), COLLTRANS_INVALID_ARGUMENT, "obstacle: ");
    EXPECT(colltrans_scene_remove(scene, id + 1), COLLTRANS_INVALID_ARGUMENT, "obstacle: ");
    EXPECT(colltrans_scene_within(scene, cube, NULL, -1, NULL, 0, ids, 1, &closer, &undecided),
           COLLTRANS_INVALID_ARGUMENT, "the length -1");
    EXPECT(colltrans_scene_within(scene, cube, NULL, 1, NULL, 0, NULL, 1, &closer, &undecided),
           COLLTRANS_NULL_ARGUMENT, "obstacles: ");
    OK(colltrans_scene_within(scene, cube, NULL, 1, NULL, 0, NULL, 0, &closer, &undecided));
    CHECK(closer == 1 && undecided == 0);
    EXPECT(colltrans_scene_clearance(scene, cube, NULL, none, NULL, NULL, 0, &id, &answer), COLLTRANS_INVALID_ARGUMENT,
           "direction");
    /* Options are checked although no solid is in the scene. */
    options.has_tolerance = 1;
    EXPECT(colltrans_scene_clearance(scene, cube, NULL, down, &options, NULL, 0, &id, &answer),
           COLLTRANS_INVALID_ARGUMENT, "options.tolerance: ");
    options.has_tolerance = 0;
    options.has_before = 1;
    options.before = NAN;
    EXPECT(colltrans_scene_clearance(scene, cube, NULL, down, &options, NULL, 0, &id, &answer),
           COLLTRANS_INVALID_ARGUMENT, "options.before: ");
    options.has_before = 0;
    for (int k = 0; k < 2; ++k) {
        colltrans_pose above = world;
        above.translation[2] = 3;
        options.features = (uint32_t)k;
        OK(colltrans_scene_clearance(scene, cube, &above, down, &options, NULL, 0, &id, &answer));
        CHECK(answer.outcome == COLLTRANS_BLOCKED);
        CHECK((answer.moving_feature.kind == COLLTRANS_UNKNOWN_FEATURE) == (k == 0));
    }
    options.features = 0;

    /* Many rows. */
    EXPECT(colltrans_clearance_many(cube, cube, NULL, NULL, &columns), COLLTRANS_NULL_ARGUMENT, "rows: ");
    rows.count = 3;
    rows.directions = down;
    EXPECT(colltrans_clearance_many(cube, cube, &rows, NULL, &columns), COLLTRANS_INVALID_ARGUMENT,
           "rows.directions: 0 directions");
    rows.direction_count = 2;
    EXPECT(colltrans_clearance_many(cube, cube, &rows, NULL, &columns), COLLTRANS_INVALID_ARGUMENT,
           "rows.directions: 2 for 3 rows");
    rows.direction_count = 1;
    EXPECT(colltrans_clearance_many(cube, cube, &rows, NULL, NULL), COLLTRANS_NULL_ARGUMENT, "columns: ");
    columns.distance = (double *)(void *)(room.bytes + 1);
    EXPECT(colltrans_clearance_many(cube, cube, &rows, NULL, &columns), COLLTRANS_MISALIGNED_ARGUMENT,
           "columns.distance: ");
    columns.distance = NULL;
    {
        colltrans_pose poses[3];
        colltrans_status statuses[3];
        colltrans_outcome outcomes[3];
        double distances[3];
        poses[0] = poses[2] = world;
        poses[2].translation[2] = 3;
        poses[1] = turned;
        rows.moving_poses = poses;
        rows.moving_pose_count = 3;
        columns.status = statuses;
        columns.outcome = outcomes;
        columns.distance = distances;
        EXPECT(colltrans_clearance_many(cube, cube, &rows, NULL, &columns), COLLTRANS_INVALID_ARGUMENT,
               "row 1: rows.moving_poses: ");
        CHECK(statuses[0] == COLLTRANS_OK && outcomes[0] == COLLTRANS_OVERLAPPING);
        CHECK(statuses[1] == COLLTRANS_INVALID_ARGUMENT && outcomes[1] == COLLTRANS_ERROR && isnan(distances[1]));
        CHECK(statuses[2] == COLLTRANS_OK && outcomes[2] == COLLTRANS_BLOCKED && fabs(distances[2] - 2) < 1e-12);
        /* The first row is no exception, and neither are rows with equal rotations. */
        poses[0] = poses[1] = poses[2];
        poses[0].translation[0] = NAN;
        memset(statuses, 7, sizeof statuses);
        rows.threads = UINT32_MAX;
        EXPECT(colltrans_clearance_many(cube, cube, &rows, NULL, &columns), COLLTRANS_INVALID_ARGUMENT,
               "row 0: rows.moving_poses: ");
        CHECK(statuses[0] == COLLTRANS_INVALID_ARGUMENT && outcomes[0] == COLLTRANS_ERROR && isnan(distances[0]));
        for (int k = 1; k < 3; ++k) {
            CHECK(statuses[k] == COLLTRANS_OK && outcomes[k] == COLLTRANS_BLOCKED && fabs(distances[k] - 2) < 1e-12);
        }
        /* An empty table has no directions. */
        memset(&rows, 0, sizeof rows);
        OK(colltrans_clearance_many(cube, cube, &rows, NULL, &columns));
    }

    /* Proofs. */
    EXPECT(colltrans_first_contact_proof(solid, NULL, cube, NULL, down, NULL, &text), COLLTRANS_INVALID_ARGUMENT,
           "prove their clearance");
    EXPECT(colltrans_within_proof(solid, NULL, cube, NULL, -1, &text), COLLTRANS_INVALID_ARGUMENT, "the length -1");
    EXPECT(colltrans_within_proof(cube, NULL, cube, NULL, NAN, &text), COLLTRANS_INVALID_ARGUMENT, "the length NaN");
    options.has_before = 1;
    options.before = 1;
    EXPECT(colltrans_clearance_proof(solid, &pose, cube, NULL, down, &options, &text), COLLTRANS_INVALID_ARGUMENT,
           "options.before: a proof has no such option");
    EXPECT(colltrans_scene_clearance_proof(scene, solid, &pose, down, &options, NULL, 0, &text),
           COLLTRANS_INVALID_ARGUMENT, "options.before: a proof has no such option");
    options.has_before = 0;
    EXPECT(colltrans_check_proof(NULL, 3, NULL), COLLTRANS_NULL_ARGUMENT, "json: ");
    EXPECT(colltrans_check_proof("{}", 2, NULL), COLLTRANS_NOT_PROVEN, "json: not a saved proof");
    EXPECT(colltrans_check_proof("\xff\xfe", 2, NULL), COLLTRANS_NOT_PROVEN, "json: ");
    CHECK(text == NULL);
    OK(colltrans_distance_proof(cube, NULL, cube, &pose, &text));
    OK(colltrans_check_proof(text, strlen(text), NULL));
    {
        /* A changed coordinate of a body is found out. */
        const size_t length = strlen(text);
        char *changed = malloc(length + 1), *at;
        CHECK(changed != NULL);
        memcpy(changed, text, length + 1);
        at = strstr(changed, "5.0");
        CHECK(at != NULL);
        at[0] = '4';
        EXPECT(colltrans_check_proof(changed, length, NULL), COLLTRANS_NOT_PROVEN, "");
        free(changed);
    }
    colltrans_text_free(text);
    /* The depth of solids is proven by translations. */
    OK(colltrans_depth_proof(solid, NULL, cube, NULL, &text));
    OK(colltrans_check_proof(text, strlen(text), NULL));
    colltrans_text_free(text);
    OK(colltrans_common_part_proof(cube, NULL, cube, NULL, 0.01, &text));
    OK(colltrans_check_proof(text, strlen(text), NULL));
    colltrans_text_free(text);
    EXPECT(colltrans_common_part_proof(cube, NULL, cube, NULL, -1.0, &text), COLLTRANS_INVALID_ARGUMENT, "accuracy");

    colltrans_scene_free(scene);
    colltrans_motion_free(rest);
    colltrans_tracker_free(tracker);
    colltrans_body_free(solid);
    colltrans_body_free(cube);
    colltrans_body_free(NULL);
    colltrans_motion_free(NULL);
    colltrans_scene_free(NULL);
    colltrans_tracker_free(NULL);
    colltrans_text_free(NULL);
    return 0;
}
