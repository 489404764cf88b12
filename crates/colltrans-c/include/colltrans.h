/* C interface of colltrans: shape casts, distances and motions with proven bounds.
 *
 * Generated from crates/colltrans-c/src. Guide: docs/guide/c-and-cpp.md. C++: colltrans.hpp.
 *
 * - Functions return COLLTRANS_OK or another status. If it is another one, colltrans_error_message() has the text, which
 *   names the argument, and no output is written, unless stated otherwise. With COLLTRANS_INTERNAL_ERROR an output may
 *   be incomplete, and Rust has printed the place of the defect to stderr.
 * - Poses, points, normals and directions are in the world frame, vertices in the frame of their body. Lengths have the
 *   unit of the bodies. A vector is three numbers, a table of vectors three numbers for each row.
 * - Numbers are 0, or have magnitudes from 2^-200 to 2^200. NaN is an error.
 * - Handles are created by a function with an output `T **` and freed by the function of their type. They share what
 *   they need: a body may be freed while a tracker or a scene still uses it.
 * - Any number of threads may pass one handle as a pointer to const. A call that takes a pointer that is not const
 *   needs the handle for itself.
 * - The same input gives the same bits on every run, thread and platform. The input of a table is all of its rows.
 */
#ifndef COLLTRANS_H
#define COLLTRANS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Number of the binary interface. It grows with every change of a struct, a number or a function. */
#define COLLTRANS_ABI 1

/** The library chooses the solver of convex bodies. */
#define COLLTRANS_SOLVER_AUTO 0

/** The algorithm of the paper (`cta`). */
#define COLLTRANS_SOLVER_CTA 1

/** Portal refinement. */
#define COLLTRANS_SOLVER_PORTAL 2

/** Obstacle of an answer that has none. */
#define COLLTRANS_NO_OBSTACLE UINT64_MAX

/** Vertex of a feature that has fewer vertices. */
#define COLLTRANS_NO_VERTEX UINT32_MAX

/** Returns the number of the binary interface. Programs compare it with `COLLTRANS_ABI` of their header. */
uint32_t colltrans_abi(void);

/** Returns the version of the library, for example `0.2.0`. The text is static. */
const char *colltrans_version(void);

/** Result of a call. `colltrans_error_message` has the text of a failure. */
typedef enum colltrans_status {
    /** The call succeeded. */
    COLLTRANS_OK = 0,
    /** A required pointer is null. */
    COLLTRANS_NULL_ARGUMENT = 1,
    /** A pointer is not aligned to its type. */
    COLLTRANS_MISALIGNED_ARGUMENT = 2,
    /** An argument is not finite, out of range, or does not fit the other ones. */
    COLLTRANS_INVALID_ARGUMENT = 3,
    /** Points or facets do not form a body. */
    COLLTRANS_INVALID_BODY = 4,
    /** The search ended without an answer. The known cases have bodies thinner than the rounding error. */
    COLLTRANS_NO_ANSWER = 5,
    /** A proof does not hold or cannot be built, or the text is not a proof. */
    COLLTRANS_NOT_PROVEN = 6,
    /** A defect of the library. Please report it. */
    COLLTRANS_INTERNAL_ERROR = 7,
} colltrans_status;

/**
 * Returns the text of the last call that failed on this thread, in UTF-8. It is empty if none failed, and valid until
 * the next failure on this thread.
 */
const char *colltrans_error_message(void);

/** A convex body or a solid. It never changes, and any number of threads may use it. */
typedef struct colltrans_body colltrans_body;

/**
 * A pose: the world coordinates of a point `x` of a body are `rotation x + translation`.
 *
 * The twelve numbers are those of a 3 x 4 matrix by columns, for example of `Eigen::AffineCompact3d`. The rotation may
 * differ from one by 1e-6. It is used unchanged, except that numbers below 2^-200 become 0.
 */
typedef struct colltrans_pose {
    /** Columns of the rotation matrix: the images of the axes. */
    double rotation[9];
    /** Translation, in world units. */
    double translation[3];
} colltrans_pose;

/** Properties of a body. */
typedef struct colltrans_body_properties {
    /** 1 for a convex body, 0 for a solid. */
    uint32_t is_convex;
    /** 1 if the surface is closed. Convex bodies are closed. */
    uint32_t is_closed;
    /** Number of vertices. */
    size_t vertex_count;
    /** Number of faces of a convex body, of triangles of a solid. */
    size_t face_count;
    /** Radius of a rounded body, otherwise 0. */
    double radius;
    /** Volume; of a solid without the radius, with overlaps of pieces counted twice. */
    double volume;
} colltrans_body_properties;

/** Builds a pose from a quaternion `x, y, z, w` of length 1 within 1e-6, and a translation. */
colltrans_status colltrans_pose_from_quaternion(const double *xyzw, const double *translation, colltrans_pose *pose);

/**
 * Builds a pose from the 16 numbers of a homogeneous matrix by columns, for example of `Eigen::Isometry3d`. The last
 * row must be `0, 0, 0, 1`.
 */
colltrans_status colltrans_pose_from_matrix(const double *matrix, colltrans_pose *pose);

/** Builds the convex hull of points, three numbers each. */
colltrans_status colltrans_convex_from_points(const double *points, size_t point_count, colltrans_body **body);

/** Builds the box between two corners, along the axes of its frame. `colltrans_feature` numbers its corners. */
colltrans_status colltrans_convex_cuboid(const double *low, const double *high, colltrans_body **body);

/**
 * Builds the hull of a closed convex mesh, and checks that the mesh is convex within a tolerance, a length.
 *
 * `indices` lists the vertices of all faces, counter-clockwise as seen from outside. `face_sizes` has the number of
 * vertices of each face; null stands for triangles.
 */
colltrans_status colltrans_convex_from_mesh(
    const double *vertices,
    size_t vertex_count,
    const uint32_t *indices,
    const uint32_t *face_sizes,
    size_t face_count,
    double convex_tolerance,
    colltrans_body **body);

/**
 * Builds a solid from a mesh, whose facets are given as in `colltrans_convex_from_mesh`. Unless `is_open` is 0, the
 * surface may be open; it then has no interior.
 */
colltrans_status colltrans_solid_from_mesh(
    const double *vertices,
    size_t vertex_count,
    const uint32_t *indices,
    const uint32_t *face_sizes,
    size_t face_count,
    uint32_t is_open,
    colltrans_body **body);

/**
 * Builds the union of bodies in one frame. The pieces may overlap, and may be freed afterwards. Rounded pieces are
 * rejected. Vertices of the union are numbered consecutively, including those that no face uses.
 */
colltrans_status colltrans_solid_from_pieces(
    const colltrans_body *const *pieces,
    size_t piece_count,
    colltrans_body **body);

/** Builds a rounded body: all points within `radius` of a body. A point becomes a sphere, a segment a capsule. */
colltrans_status colltrans_body_rounded(const colltrans_body *core, double radius, colltrans_body **body);

/** Builds another handle of the same body, which shares its memory. */
colltrans_status colltrans_body_clone(const colltrans_body *body, colltrans_body **clone);

/** Frees a body; null is accepted. */
void colltrans_body_free(colltrans_body *body);

/** Returns the properties of a body. */
colltrans_status colltrans_body_info(const colltrans_body *body, colltrans_body_properties *info);

/** Outcome of a query. */
typedef enum colltrans_outcome {
    /** The query has no answer. */
    COLLTRANS_ERROR = 0,
    /** The bodies meet along the direction or the motion. */
    COLLTRANS_CONTACT = 1,
    /**
     * Convex bodies slide along each other, to within the graze tolerance; rotating bodies come nearer than rounding
     * errors can decide.
     */
    COLLTRANS_GRAZING = 2,
    /** The bodies never meet along the direction. */
    COLLTRANS_SEPARATED = 3,
    /** Nothing blocks a solid, a body in a scene, or a motion; with the option `before`, not before this translation. */
    COLLTRANS_FREE = 4,
    /** The body is blocked after a finite distance. */
    COLLTRANS_BLOCKED = 5,
    /** Nothing blocks a convex body, because it slides along the other one. */
    COLLTRANS_SLIDES = 6,
    /** Nothing blocks a convex body, because the only contacts are behind it. */
    COLLTRANS_BEHIND = 7,
    /** The bodies overlap at the start. */
    COLLTRANS_OVERLAPPING = 8,
    /** The bodies have no common point. */
    COLLTRANS_APART = 9,
    /** The bodies touch, or overlap by less than the rounding error. */
    COLLTRANS_TOUCHING = 10,
    /** The bodies touch or overlap, or are so near that rounding cannot decide. */
    COLLTRANS_MEETING = 11,
    /** The distance is at most the length. */
    COLLTRANS_CLOSER = 12,
    /** The distance is larger than the length. */
    COLLTRANS_FARTHER = 13,
    /** The length lies between the bounds of the distance, or the search along a motion took its maximum of steps. */
    COLLTRANS_UNDECIDED = 14,
} colltrans_outcome;

/** Kind of a feature. */
typedef enum colltrans_feature_kind {
    /** The feature is unknown, or was not requested. */
    COLLTRANS_UNKNOWN_FEATURE = 0,
    /** A vertex. */
    COLLTRANS_VERTEX = 1,
    /** An edge. */
    COLLTRANS_EDGE = 2,
    /** A face. */
    COLLTRANS_FACE = 3,
} colltrans_feature_kind;

/**
 * Vertex, edge or face of a body, by the indices of its points or of the vertices of its mesh. The vertices of the
 * pieces of a union are numbered consecutively, those that no face uses too. Corner `k` of a cuboid has the high
 * coordinate of axis `j` if bit `j` of `k` is 1.
 */
typedef struct colltrans_feature {
    /** Kind of the feature. */
    colltrans_feature_kind kind;
    /** The vertex, the two ends, or the first three corners; the rest is `COLLTRANS_NO_VERTEX`. */
    uint32_t vertices[3];
} colltrans_feature;

/**
 * Answer of a cast. Translations, bounds, `distance`, `exit`, `back`, `on` and `rounding` are multiples of the
 * direction: they are lengths if it is a unit vector. Numbers that do not apply are NaN.
 */
typedef struct colltrans_cast_answer {
    /** Outcome of the query. */
    colltrans_outcome outcome;
    /**
     * Safe travel of a clearance, a multiple of the direction: proven, infinite for a free body, at most the option
     * `before`.
     */
    double distance;
    /** First contact. */
    double translation;
    /** Proven lower bound of the first contact. */
    double translation_lower;
    /** Proven upper bound of the first contact. */
    double translation_upper;
    /** Last contact. */
    double exit;
    /** Proven lower bound of the last contact. */
    double exit_lower;
    /** Proven upper bound of the last contact. Beyond it the bodies never meet. */
    double exit_upper;
    /** For convex bodies that overlap, travel backwards that certainly separates them. */
    double back;
    /** For convex bodies that overlap, travel forwards that certainly separates them. */
    double on;
    /** Overlap of the shadows of convex bodies that graze or slide, a length. */
    double overlap;
    /** Gap between the shadows of separated convex bodies, a length. */
    double margin;
    /** The part of the bounds' difference that rounding explains, for convex bodies. */
    double rounding;
    /** Tolerance in use, a length, for solids. */
    double tolerance;
    /** For solids that overlap, the smallest tolerance at which they do not, otherwise NaN. */
    double least_tolerance;
    /** Unit normal of the contact plane or the separating plane, from the moving to the fixed body. */
    double normal[3];
    /** Contact point on the moving body at its start pose. */
    double point_on_moving[3];
    /** Contact point on the fixed body. */
    double point_on_fixed[3];
    /** Feature of the moving body in contact, if features are requested. */
    colltrans_feature moving_feature;
    /** Feature of the fixed body in contact, if features are requested. */
    colltrans_feature fixed_feature;
} colltrans_cast_answer;

/** Answer of a distance, or of its comparison with a length. Bounds that were not computed are 0 and infinity. */
typedef struct colltrans_distance_answer {
    /** Outcome of the query. */
    colltrans_outcome outcome;
    /** Proven lower bound of the distance. */
    double lower;
    /** Proven upper bound of the distance. */
    double upper;
    /** Unit normal along the shortest connection, from the moving to the fixed body; NaN if the bodies meet. */
    double normal[3];
    /** Point of the moving body at the distance `upper`, rounded; NaN if it was not computed. */
    double point_on_moving[3];
    /** Point of the fixed body at the distance `upper`, rounded; NaN if it was not computed. */
    double point_on_fixed[3];
    /** Feature of the moving body at its nearest point, unless the query is about a scene. */
    colltrans_feature moving_feature;
    /** Feature of the fixed body at its nearest point, unless the query is about a scene. */
    colltrans_feature fixed_feature;
} colltrans_distance_answer;

/** Answer of a penetration depth. */
typedef struct colltrans_depth_answer {
    /** Outcome of the query. */
    colltrans_outcome outcome;
    /** Proven lower bound of the depth; NaN if it is unknown, as for open surfaces. */
    double lower;
    /** Proven upper bound of the depth; NaN if it is unknown. */
    double upper;
    /** For solids that overlap, the smallest tolerance at which they do not, otherwise NaN. */
    double least_tolerance;
    /** Unit vector along which a translation of the moving body by `upper` separates the bodies. */
    double direction[3];
} colltrans_depth_answer;

/** Answer about bodies along their motions, from time 0 to time 1. */
typedef struct colltrans_motion_answer {
    /** Outcome of the query. */
    colltrans_outcome outcome;
    /** Proven lower bound of the time of contact: the bodies do not meet before. NaN without a contact. */
    double time_lower;
    /** Proven upper bound of the time of contact; infinite if no contact is proven. NaN without a contact. */
    double time_upper;
    /** Tolerance in use, a length; NaN without one. */
    double tolerance;
    /** For solids that overlap at the start, the smallest tolerance at which they do not, otherwise NaN. */
    double least_tolerance;
    /** Unit normal at the contact, from the moving to the fixed body. */
    double normal[3];
    /** Contact point on the fixed body. */
    double point[3];
    /** Feature of the moving body in contact. */
    colltrans_feature moving_feature;
    /** Feature of the fixed body in contact. */
    colltrans_feature fixed_feature;
} colltrans_motion_answer;

/**
 * Columns for the answers of many casts. Each pointer is null or has room for all rows; vectors have three numbers for
 * each row. The fields are those of `colltrans_cast_answer`.
 */
typedef struct colltrans_cast_columns {
    /** Status of each row. */
    colltrans_status *status;
    /** Outcomes. */
    colltrans_outcome *outcome;
    /** Safe travels. */
    double *distance;
    /** First contacts. */
    double *translation;
    /** Lower bounds of the first contacts. */
    double *translation_lower;
    /** Upper bounds of the first contacts. */
    double *translation_upper;
    /** Last contacts. */
    double *exit;
    /** Lower bounds of the last contacts. */
    double *exit_lower;
    /** Upper bounds of the last contacts. */
    double *exit_upper;
    /** Travels backwards. */
    double *back;
    /** Travels forwards. */
    double *on;
    /** Overlaps of shadows. */
    double *overlap;
    /** Gaps between shadows. */
    double *margin;
    /** Parts of the bounds' differences that rounding explains. */
    double *rounding;
    /** Tolerances. */
    double *tolerance;
    /** Least tolerances. */
    double *least_tolerance;
    /** Normals. */
    double *normal;
    /** Contact points on the moving body at its start pose. */
    double *point_on_moving;
    /** Contact points on the fixed body. */
    double *point_on_fixed;
    /** Features of the moving body. */
    colltrans_feature *moving_feature;
    /** Features of the fixed body. */
    colltrans_feature *fixed_feature;
} colltrans_cast_columns;

/** Columns for many distances, as `colltrans_cast_columns`. The fields are those of `colltrans_distance_answer`. */
typedef struct colltrans_distance_columns {
    /** Status of each row. */
    colltrans_status *status;
    /** Outcomes. */
    colltrans_outcome *outcome;
    /** Lower bounds. */
    double *lower;
    /** Upper bounds. */
    double *upper;
    /** Normals. */
    double *normal;
    /** Points of the moving body. */
    double *point_on_moving;
    /** Points of the fixed body. */
    double *point_on_fixed;
    /** Features of the moving body. */
    colltrans_feature *moving_feature;
    /** Features of the fixed body. */
    colltrans_feature *fixed_feature;
} colltrans_distance_columns;

/** Options of a cast or a motion. A zeroed struct has the defaults, and so has a null pointer. */
typedef struct colltrans_cast_options {
    /** Minimum gap, a length: the bodies stop when their distance falls to it. */
    double min_gap;
    /** Convex bodies that overlap sideways by at most this length slide along each other. */
    double graze_tolerance;
    /**
     * Solids are shrunk by half of this length each, if `has_tolerance` is not 0. Otherwise the tolerance is that of
     * rounding. For a motion of convex bodies, the depth to which they may overlap.
     */
    double tolerance;
    /**
     * End of the clearance of solids and in scenes, if `has_before` is not 0: contacts from this translation on do not
     * stop the body, and the clearance is at most this translation. Other queries of solids do not use it.
     */
    double before;
    /** Whether `tolerance` is set. */
    uint32_t has_tolerance;
    /** Whether `before` is set. */
    uint32_t has_before;
    /** Whether the clearance of solids ignores facets that cross at the start. */
    uint32_t ignore_start_overlap;
    /** Solver of convex bodies: `COLLTRANS_SOLVER_AUTO` (0), `COLLTRANS_SOLVER_CTA` or `COLLTRANS_SOLVER_PORTAL`. */
    uint32_t solver;
    /** Whether casts of convex bodies compute the features in contact. Those of solids are always computed. */
    uint32_t features;
} colltrans_cast_options;

/**
 * Finds the first translation at which the bodies meet. It is negative for a contact behind the moving body or an
 * overlap at the start. Null poses are the identity, null options the defaults.
 */
colltrans_status colltrans_first_contact(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    const double *direction,
    const colltrans_cast_options *options,
    colltrans_cast_answer *answer);

/** Finds the first contact and the last one, after which the bodies never meet (`exit`). */
colltrans_status colltrans_contact_range(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    const double *direction,
    const colltrans_cast_options *options,
    colltrans_cast_answer *answer);

/** Finds how far the moving body can move from its pose, and what stops it. */
colltrans_status colltrans_clearance(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    const double *direction,
    const colltrans_cast_options *options,
    colltrans_cast_answer *answer);

/**
 * Checks whether the bodies have a common point in their poses, or are within the minimum gap of the options. Writes 1
 * or 0.
 */
colltrans_status colltrans_intersects(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    const colltrans_cast_options *options,
    uint32_t *meets);

/** Computes the distance of the bodies and their nearest points. Null poses are the identity. */
colltrans_status colltrans_distance(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    colltrans_distance_answer *answer);

/** Computes the lower and the upper bound of the distance, without points and features. */
colltrans_status colltrans_distance_bounds(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    double *bounds);

/** Decides whether the bodies are closer than a length. */
colltrans_status colltrans_within(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    double length,
    colltrans_distance_answer *answer);

/**
 * Computes the shortest translation that separates convex bodies, or the least tolerance at which solids do not
 * overlap.
 */
colltrans_status colltrans_depth(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    colltrans_depth_answer *answer);

/**
 * A sequence of similar queries about convex bodies, each of which starts from the last answer. Queries change it, so
 * each thread needs one of its own.
 */
typedef struct colltrans_tracker colltrans_tracker;

/** Builds a tracker. */
colltrans_status colltrans_tracker_new(colltrans_tracker **tracker);

/** Frees a tracker; null is accepted. */
void colltrans_tracker_free(colltrans_tracker *tracker);

/** Discards the last answer: the next query starts from scratch. */
colltrans_status colltrans_tracker_reset(colltrans_tracker *tracker);

/** Computes `colltrans_first_contact` from the last answer. */
colltrans_status colltrans_tracker_first_contact(
    colltrans_tracker *tracker,
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    const double *direction,
    const colltrans_cast_options *options,
    colltrans_cast_answer *answer);

/** Computes `colltrans_contact_range` from the last answer. */
colltrans_status colltrans_tracker_contact_range(
    colltrans_tracker *tracker,
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    const double *direction,
    const colltrans_cast_options *options,
    colltrans_cast_answer *answer);

/** Computes `colltrans_clearance` from the last answer. */
colltrans_status colltrans_tracker_clearance(
    colltrans_tracker *tracker,
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    const double *direction,
    const colltrans_cast_options *options,
    colltrans_cast_answer *answer);

/** Computes `colltrans_distance` from the last answer. */
colltrans_status colltrans_tracker_distance(
    colltrans_tracker *tracker,
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    colltrans_distance_answer *answer);

/** The pose of a body at all times from 0 to 1. It never changes, and any number of threads may use it. */
typedef struct colltrans_motion colltrans_motion;

/** Builds the motion of a body at rest. A null pose is the identity. */
colltrans_status colltrans_motion_rest(const colltrans_pose *pose, colltrans_motion **motion);

/** Builds a translation by a vector. */
colltrans_status colltrans_motion_translation(
    const colltrans_pose *pose,
    const double *displacement,
    colltrans_motion **motion);

/**
 * Builds a rotation by `angle` radians about an axis through a point of the world, with a translation by `rise` along
 * the axis.
 */
colltrans_status colltrans_motion_screw(
    const colltrans_pose *pose,
    const double *point,
    const double *axis,
    double angle,
    double rise,
    colltrans_motion **motion);

/**
 * Builds a free flight: a point of the world that moves with the body has a constant velocity, and the body rotates
 * about it at a constant angular velocity, in radians for the unit of time.
 */
colltrans_status colltrans_motion_free_flight(
    const colltrans_pose *pose,
    const double *center,
    const double *velocity,
    const double *angular_velocity,
    colltrans_motion **motion);

/** Builds screw motions from each pose to the next one, of equal durations. */
colltrans_status colltrans_motion_through_poses(
    const colltrans_pose *poses,
    size_t pose_count,
    colltrans_motion **motion);

/** Frees a motion; null is accepted. */
void colltrans_motion_free(colltrans_motion *motion);

/** Computes the pose at a time from 0 to 1, rounded. */
colltrans_status colltrans_motion_pose_at(const colltrans_motion *motion, double time, colltrans_pose *pose);

/** Finds the first time at which the bodies meet along their motions. */
colltrans_status colltrans_motion_first_contact(
    const colltrans_body *moving,
    const colltrans_motion *moving_motion,
    const colltrans_body *fixed,
    const colltrans_motion *fixed_motion,
    const colltrans_cast_options *options,
    colltrans_motion_answer *answer);

/**
 * Finds how far the bodies can move along their motions. Bodies that touch at the start do not block each other unless
 * the motion makes them overlap.
 */
colltrans_status colltrans_motion_clearance(
    const colltrans_body *moving,
    const colltrans_motion *moving_motion,
    const colltrans_body *fixed,
    const colltrans_motion *fixed_motion,
    const colltrans_cast_options *options,
    colltrans_motion_answer *answer);

/** Placed bodies, the obstacles of a moving body. Any number of threads may query a scene while none changes it. */
typedef struct colltrans_scene colltrans_scene;

/** Builds an empty scene. */
colltrans_status colltrans_scene_new(colltrans_scene **scene);

/** Frees a scene; null is accepted. */
void colltrans_scene_free(colltrans_scene *scene);

/** Inserts a body at a pose, and writes the number of the new obstacle. The body may be freed afterwards. */
colltrans_status colltrans_scene_insert(
    colltrans_scene *scene,
    const colltrans_body *body,
    const colltrans_pose *pose,
    uint64_t *obstacle);

/** Moves an obstacle to another pose. */
colltrans_status colltrans_scene_set_pose(colltrans_scene *scene, uint64_t obstacle, const colltrans_pose *pose);

/** Removes an obstacle. */
colltrans_status colltrans_scene_remove(colltrans_scene *scene, uint64_t obstacle);

/** Writes the number of obstacles. */
colltrans_status colltrans_scene_size(const colltrans_scene *scene, size_t *size);

/**
 * Finds the obstacle that is nearest to a body. `lower` and the outcome hold for all obstacles together, and the
 * features are unknown. Without obstacles, writes `COLLTRANS_NO_OBSTACLE`, the outcome `COLLTRANS_APART` and infinite
 * bounds.
 *
 * `ignored` lists obstacles that the query leaves out, for example the parts of a gripper.
 */
colltrans_status colltrans_scene_nearest(
    const colltrans_scene *scene,
    const colltrans_body *body,
    const colltrans_pose *pose,
    const uint64_t *ignored,
    size_t ignored_count,
    uint64_t *obstacle,
    colltrans_distance_answer *answer);

/**
 * Finds the obstacles that are closer to a body than a length. Writes the numbers of the closer ones and then of those
 * that rounding cannot decide, at most `capacity` in all, and how many there are of each.
 */
colltrans_status colltrans_scene_within(
    const colltrans_scene *scene,
    const colltrans_body *body,
    const colltrans_pose *pose,
    double length,
    const uint64_t *ignored,
    size_t ignored_count,
    uint64_t *obstacles,
    size_t capacity,
    size_t *closer_count,
    size_t *undecided_count);

/**
 * Finds how far a body can move along a direction, and the obstacle that stops it, or `COLLTRANS_NO_OBSTACLE`.
 * `distance` holds for all obstacles together, the other numbers for this obstacle.
 */
colltrans_status colltrans_scene_clearance(
    const colltrans_scene *scene,
    const colltrans_body *body,
    const colltrans_pose *pose,
    const double *direction,
    const colltrans_cast_options *options,
    const uint64_t *ignored,
    size_t ignored_count,
    uint64_t *obstacle,
    colltrans_cast_answer *answer);

/** Rows of a table of queries about two bodies. */
typedef struct colltrans_rows {
    /** Number of rows. */
    size_t count;
    /** Poses of the moving body. */
    const colltrans_pose *moving_poses;
    /** Number of these poses: `count`, 1 for all rows, or 0 for the identity. */
    size_t moving_pose_count;
    /** Poses of the fixed body. */
    const colltrans_pose *fixed_poses;
    /** Number of these poses: `count`, 1 for all rows, or 0 for the identity. */
    size_t fixed_pose_count;
    /** Directions of casts, three numbers each. */
    const double *directions;
    /** Number of directions: `count`, or 1 for all rows. Distances have none; an empty table needs none. */
    size_t direction_count;
    /** Number of threads, at most 1024; 0 takes one for each processor. If the system refuses a thread, fewer are used. */
    uint32_t threads;
} colltrans_rows;

/**
 * Finds the first contact of each row, as `colltrans_first_contact`.
 *
 * From some hundred rows with equal rotations on, convex bodies share data between rows. The last digits, and the plane
 * of separated bodies, may then differ from those of single calls.
 *
 * A row without an answer has its status in the column `status`, and the outcome `COLLTRANS_ERROR`. The call then
 * returns the status of the first such row, and all other rows have their answers.
 */
colltrans_status colltrans_first_contact_many(
    const colltrans_body *moving,
    const colltrans_body *fixed,
    const colltrans_rows *rows,
    const colltrans_cast_options *options,
    const colltrans_cast_columns *columns);

/**
 * Finds the first and the last contact of each row. Rows without an answer are those of
 * `colltrans_first_contact_many`.
 */
colltrans_status colltrans_contact_range_many(
    const colltrans_body *moving,
    const colltrans_body *fixed,
    const colltrans_rows *rows,
    const colltrans_cast_options *options,
    const colltrans_cast_columns *columns);

/** Finds the clearance of each row. Rows without an answer are those of `colltrans_first_contact_many`. */
colltrans_status colltrans_clearance_many(
    const colltrans_body *moving,
    const colltrans_body *fixed,
    const colltrans_rows *rows,
    const colltrans_cast_options *options,
    const colltrans_cast_columns *columns);

/** Computes the distance of each row. Rows without an answer are those of `colltrans_first_contact_many`. */
colltrans_status colltrans_distance_many(
    const colltrans_body *moving,
    const colltrans_body *fixed,
    const colltrans_rows *rows,
    const colltrans_distance_columns *columns);

/** Frees a text of the library; null is accepted. The text must be unchanged. */
void colltrans_text_free(const char *text);

/**
 * Proves `colltrans_first_contact` of convex bodies. The text has the bodies, the query and the certificate; it is
 * freed by `colltrans_text_free`.
 */
colltrans_status colltrans_first_contact_proof(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    const double *direction,
    const colltrans_cast_options *options,
    const char **json);

/** Proves `colltrans_clearance`, up to infinity. The option `before` is rejected. */
colltrans_status colltrans_clearance_proof(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    const double *direction,
    const colltrans_cast_options *options,
    const char **json);

/** Proves `colltrans_distance`. */
colltrans_status colltrans_distance_proof(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    const char **json);

/** Proves `colltrans_within`. */
colltrans_status colltrans_within_proof(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    double length,
    const char **json);

/** Proves the depth. For solids the bounds of the proof may be farther apart than those of `colltrans_depth`. */
colltrans_status colltrans_depth_proof(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    const char **json);

/**
 * Proves how much of the bodies overlaps: bounds of the volume of their common part, its box, and how the bodies lie to
 * each other. Convex bodies are treated as solids. The bounds differ by at most `accuracy`, a share of the lower one,
 * unless the search ends before, after a limited amount of work.
 */
colltrans_status colltrans_common_part_proof(
    const colltrans_body *moving,
    const colltrans_pose *moving_pose,
    const colltrans_body *fixed,
    const colltrans_pose *fixed_pose,
    double accuracy,
    const char **json);

/** Proves `colltrans_motion_first_contact`. */
colltrans_status colltrans_motion_proof(
    const colltrans_body *moving,
    const colltrans_motion *moving_motion,
    const colltrans_body *fixed,
    const colltrans_motion *fixed_motion,
    const colltrans_cast_options *options,
    const char **json);

/** Proves `colltrans_scene_nearest`. A scene without obstacles has no proof. */
colltrans_status colltrans_scene_nearest_proof(
    const colltrans_scene *scene,
    const colltrans_body *body,
    const colltrans_pose *pose,
    const uint64_t *ignored,
    size_t ignored_count,
    const char **json);

/** Proves `colltrans_scene_clearance`, up to infinity. */
colltrans_status colltrans_scene_clearance_proof(
    const colltrans_scene *scene,
    const colltrans_body *body,
    const colltrans_pose *pose,
    const double *direction,
    const colltrans_cast_options *options,
    const uint64_t *ignored,
    size_t ignored_count,
    const char **json);

/**
 * Checks a proof, of `length` bytes, without a search and without trust in its numbers. Writes the proven statement in
 * words unless `statement` is null; `colltrans_text_free` frees it.
 */
colltrans_status colltrans_check_proof(const char *json, size_t length, const char **statement);

/* Options of a compiler for shorter enums, such as -fshort-enums, change the interface. */
#if defined(__cplusplus)
static_assert(sizeof(colltrans_status) == 4 && sizeof(colltrans_outcome) == 4, "enums have 4 bytes");
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
_Static_assert(sizeof(colltrans_status) == 4 && sizeof(colltrans_outcome) == 4, "enums have 4 bytes");
#endif

#ifdef __cplusplus
}
#endif

#endif
