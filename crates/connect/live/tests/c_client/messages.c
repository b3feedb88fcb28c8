/*
 * Carries out what is on its standard input with the client in C, one line each, and prints what comes of it:
 *
 *     S NOW STAMP JOINTS VELOCITY INTENT ATTACHED   a joint state; its bytes in hexadecimal
 *     A NOW HEX                                     an answer; how it was taken, and the override afterwards
 *     K CELL ROBOT                                  the key of a robot's joint states
 *     D KEY HEX                                     the contents of a datagram, or "-"
 */
#include "elbowroom_client.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#define BOOT 7u
#define CONFIGURATION 99u
#define STALE_US 20000u

static void print_hex(const uint8_t *bytes, size_t length)
{
    size_t i;
    for (i = 0; i < length; i++)
        printf("%02x", bytes[i]);
    printf("\n");
}

static size_t parse_hex(const char *text, uint8_t *bytes, size_t capacity)
{
    size_t length = 0;
    unsigned byte;
    while (length < capacity && sscanf(text, "%2x", &byte) == 1) {
        bytes[length++] = (uint8_t)byte;
        text += 2;
    }
    return length;
}

static void joint_state(elbowroom_client *client, const char *line)
{
    static double q[64], qd[64], intent[64];
    static elbowroom_attached attached[64];
    static const double quaternions[3][4] = {{0, 0, 0, 1}, {1, 0, 0, 0}, {0.5, 0.5, 0.5, 0.5}};
    uint8_t bytes[ELBOWROOM_JOINT_STATE_BYTES];
    elbowroom_state state;
    uint64_t now;
    size_t joints, volumes, i;
    int has_velocity, has_intent;
    memset(&state, 0, sizeof state);
    if (sscanf(line, "S %" SCNu64 " %" SCNu64 " %zu %d %d %zu", &now, &state.stamp_us, &joints, &has_velocity, &has_intent,
               &volumes) != 6
        || joints > 64 || volumes > 64)
        exit(1);
    for (i = 0; i < 64; i++) {
        const double x = (double)(now % 1000) + (double)i;
        q[i] = x / 8.0;
        qd[i] = -x / 3.0;
        intent[i] = x * 1e-300;
        attached[i].volume = (uint16_t)(i * 1000);
        attached[i].position_m[0] = x / 7.0;
        attached[i].position_m[1] = -0.25;
        attached[i].position_m[2] = (double)i;
        memcpy(attached[i].quaternion_xyzw, quaternions[i % 3], sizeof quaternions[0]);
    }
    state.joints = joints;
    state.q = q;
    state.qd = has_velocity ? qd : NULL;
    state.intent = has_intent ? intent : NULL;
    state.programmed_override = 0.75;
    state.attached = attached;
    state.attached_count = volumes;
    print_hex(bytes, elbowroom_joint_state(client, now, &state, bytes, sizeof bytes));
}

static void datagram(const char *key, const char *hex)
{
    static uint8_t bytes[4096];
    const size_t length = parse_hex(hex, bytes, sizeof bytes);
    size_t contents_length = 0;
    const uint8_t *contents = elbowroom_contents(bytes, length, key, &contents_length);
    if (contents == NULL)
        printf("-\n");
    else
        print_hex(contents, contents_length);
}

int main(void)
{
    static char line[8192], text[8192], cell[256], robot[256];
    elbowroom_client client;
    uint8_t bytes[256];
    uint64_t now;
    setvbuf(stdout, NULL, _IOLBF, 8192); /* the other side waits for each line */
    elbowroom_client_init(&client, BOOT, CONFIGURATION, STALE_US);
    while (fgets(line, sizeof line, stdin) != NULL) {
        if (line[0] == 'S') {
            joint_state(&client, line);
        } else if (sscanf(line, "A %" SCNu64 " %8000s", &now, text) == 2) {
            const size_t length = parse_hex(text, bytes, sizeof bytes);
            const int taken = elbowroom_receive(&client, bytes, length);
            printf("%d %.17g\n", taken, elbowroom_speed_override(&client, now));
        } else if (sscanf(line, "K %255s %255s", cell, robot) == 2) {
            printf("%s\n", elbowroom_key(text, 256, cell, robot, "joint_states") ? text : "-");
        } else if (sscanf(line, "D %255s %8000s", cell, text) == 2) {
            datagram(cell, text);
        } else {
            return 1;
        }
    }
    return 0;
}
