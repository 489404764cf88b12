/* Lowers a pyramid onto a plate, and verifies the proof of the answer. */
#include <colltrans.h>
#include <stdio.h>
#include <string.h>

static int failed(const char *call) {
    fprintf(stderr, "%s: %s\n", call, colltrans_error_message());
    return 1;
}

int main(void) {
    const double corners[] = {-1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1, 0, 0, 0};
    const double low[] = {-2, -2, -1}, high[] = {2, 2, 0}, down[] = {0, 0, -1};
    const double no_turn[] = {0, 0, 0, 1}, above[] = {0.5, 0, 3};
    colltrans_body *pyramid = NULL, *plate = NULL;
    colltrans_pose start;
    colltrans_cast_answer answer;
    const char *proof = NULL, *statement = NULL;

    if (colltrans_abi() != COLLTRANS_ABI) return 1;
    if (colltrans_convex_from_points(corners, 5, &pyramid)) return failed("pyramid");
    if (colltrans_convex_cuboid(low, high, &plate)) return failed("plate");
    if (colltrans_pose_from_quaternion(no_turn, above, &start)) return failed("start");

    /* A null pose is the identity, null options are the defaults. */
    if (colltrans_first_contact(pyramid, &start, plate, NULL, down, NULL, &answer)) return failed("cast");
    if (answer.outcome == COLLTRANS_CONTACT) {
        printf("contact after %g, at (%g, %g, %g)\n", answer.translation, answer.point_on_fixed[0],
               answer.point_on_fixed[1], answer.point_on_fixed[2]);
    }

    if (colltrans_first_contact_proof(pyramid, &start, plate, NULL, down, NULL, &proof)) return failed("proof");
    if (colltrans_check_proof(proof, strlen(proof), &statement)) return failed("check");
    printf("proven: %s\n", statement);

    colltrans_text_free(statement);
    colltrans_text_free(proof);
    colltrans_body_free(plate);
    colltrans_body_free(pyramid);
    return 0;
}
