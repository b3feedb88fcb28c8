/*
 * A controller: moves a robot to and fro between two configurations at 250 Hz, as fast as its node permits, over UDP.
 *
 *     cc -std=c99 -O2 -o example example.c -lm
 *     ./example 127.0.0.1 7448 rail rail 10 0.2 1.0 [6f1c...]
 *
 * HOST and PORT of the node, CELL, ROBOT, SECONDS, the two configurations: one value per joint, rad or m, with commas between
 * them; and the 16 digits of the cell file's checksum, which every process of the service prints at its start. A node with exchange
 * regions obeys no controller without them. Its joints are moved here by arithmetic; a real controller reads them from its encoders,
 * and hands the override to its interpolator.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#define _POSIX_C_SOURCE 200809L

#include "elbowroom_client.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>

#define TICK_US 4000u
#define MOST_LATE_US (5u * TICK_US)
#define STALE_US 20000u       /* stale_ms of the cell file */
#define SUBSCRIBE_US 1000000u /* how often the subscription is repeated */
#define PRINT_US 100000u
#define PASS_S 4.0 /* from one configuration to the other at override 1 */

/* The motion: how far the program is, and the joints there. */
typedef struct {
    size_t joints;
    double from[ELBOWROOM_MAX_JOINTS], to[ELBOWROOM_MAX_JOINTS];
    double time_s; /* of the program */
    double q[ELBOWROOM_MAX_JOINTS], qd[ELBOWROOM_MAX_JOINTS], intent[ELBOWROOM_MAX_JOINTS];
} motion;

/* The connection to the node. */
typedef struct {
    int socket;
    struct sockaddr_storage node;
    socklen_t node_length;
    char joint_states[256], speed_override[256];
} connection;

/* Goes on while the computer is suspended: an answer from before the sleep is old after it. */
#ifdef CLOCK_BOOTTIME
#define STEADY_CLOCK CLOCK_BOOTTIME
#else
#define STEADY_CLOCK CLOCK_MONOTONIC
#endif

static uint64_t clock_ns(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

static uint64_t now_us(void)
{
    return clock_ns(STEADY_CLOCK) / 1000u;
}

static void sleep_until_us(uint64_t due_us)
{
    struct timespec t;
    t.tv_sec = (time_t)(due_us / 1000000u);
    t.tv_nsec = (long)(due_us % 1000000u) * 1000;
    while (clock_nanosleep(STEADY_CLOCK, TIMER_ABSTIME, &t, NULL) == EINTR) {
    }
}

/* Moves on by a tick under an override. */
static void advance(motion *m, double speed_override, double dt_s)
{
    const double rate = acos(-1.0) / PASS_S;
    size_t i;
    m->time_s += speed_override * dt_s;
    for (i = 0; i < m->joints; i++) {
        const double half = 0.5 * (m->to[i] - m->from[i]);
        m->q[i] = m->from[i] + half * (1.0 - cos(rate * m->time_s));
        m->intent[i] = half * rate * sin(rate * m->time_s);
        m->qd[i] = m->intent[i] * speed_override;
    }
}

/* Values with commas between them; their number, 0 where they are no such list. */
static size_t parse_joints(const char *text, double *values)
{
    size_t count = 0;
    while (count < ELBOWROOM_MAX_JOINTS) {
        char *end;
        values[count++] = strtod(text, &end);
        if (end == text)
            return 0;
        if (*end == '\0')
            return count;
        if (*end != ',')
            return 0;
        text = end + 1;
    }
    return 0;
}

/* The number of 16 hexadecimal digits; 0 where the text is none. */
static uint64_t parse_checksum(const char *text)
{
    const int is_one = strlen(text) == 16 && strspn(text, "0123456789abcdef") == 16;
    return is_one ? strtoull(text, NULL, 16) : 0;
}

static int open_connection(connection *c, const char *host, const char *port, const char *cell, const char *robot)
{
    struct addrinfo hints, *found = NULL;
    memset(&hints, 0, sizeof hints);
    hints.ai_socktype = SOCK_DGRAM;
    if (getaddrinfo(host, port, &hints, &found) != 0 || found == NULL)
        return 0;
    memcpy(&c->node, found->ai_addr, found->ai_addrlen);
    c->node_length = (socklen_t)found->ai_addrlen;
    c->socket = socket(found->ai_family, SOCK_DGRAM, 0);
    freeaddrinfo(found);
    return c->socket >= 0 && fcntl(c->socket, F_SETFL, O_NONBLOCK) == 0
        && elbowroom_key(c->joint_states, sizeof c->joint_states, cell, robot, "joint_states")
        && elbowroom_key(c->speed_override, sizeof c->speed_override, cell, robot, "override");
}

/* Sends a message under a key. One that cannot be sent is superseded by the next one. */
static void send_message(const connection *c, uint8_t kind, const char *key, const uint8_t *contents, size_t length)
{
    uint8_t datagram[ELBOWROOM_FRAME_BYTES + ELBOWROOM_JOINT_STATE_BYTES];
    const size_t count = elbowroom_datagram(kind, key, contents, length, datagram, sizeof datagram);
    if (count > 0)
        (void)sendto(c->socket, datagram, count, 0, (const struct sockaddr *)&c->node, c->node_length);
}

/* Takes all answers that have arrived. Returns how many were not obeyed. */
static unsigned receive_answers(const connection *c, elbowroom_client *client)
{
    uint8_t datagram[ELBOWROOM_FRAME_BYTES + ELBOWROOM_ANSWER_BYTES];
    unsigned refused = 0;
    int most;
    for (most = 0; most < 100; most++) {
        const ssize_t count = recv(c->socket, datagram, sizeof datagram, 0);
        size_t length = 0;
        const uint8_t *contents;
        if (count < 0)
            break;
        contents = elbowroom_contents(datagram, (size_t)count, c->speed_override, &length);
        if (contents != NULL && elbowroom_receive(client, contents, length) != ELBOWROOM_OBEYED)
            refused++;
    }
    return refused;
}

static void print_state(const elbowroom_client *client, const motion *m, uint64_t now, uint64_t began)
{
    static const char *const reasons[] = {"free", "region", "speed zone", "waiting", "rate", "fault", "halted"};
    const elbowroom_answer *answer = elbowroom_answer_at(client, now);
    const char *reason = "no answer";
    if (answer != NULL)
        reason = answer->reason < sizeof reasons / sizeof *reasons ? reasons[answer->reason] : "unknown";
    printf("%.1f s: override %.3f, %s, first joint at %.4f\n", (double)(now - began) * 1e-6,
           elbowroom_speed_override(client, now), reason, m->q[0]);
    fflush(stdout);
}

/* The control loop. */
static void drive(const connection *c, motion *m, double seconds, uint64_t configuration)
{
    elbowroom_client client;
    const uint64_t began = now_us();
    uint64_t due = began;
    const uint64_t ticks = (uint64_t)(seconds * 1e6) / TICK_US;
    uint64_t tick;
    unsigned refused = 0;
    elbowroom_client_init(&client, clock_ns(CLOCK_REALTIME), configuration, STALE_US);
    for (tick = 0; tick < ticks; tick++) {
        uint8_t bytes[ELBOWROOM_JOINT_STATE_BYTES];
        elbowroom_state state;
        uint64_t now;
        size_t length;
        sleep_until_us(due);
        now = now_us();
        /* Held up, or the computer has slept: what was missed is not made up for. */
        if (now > due + MOST_LATE_US)
            due = now;
        due += TICK_US;
        refused += receive_answers(c, &client);
        advance(m, elbowroom_speed_override(&client, now), TICK_US * 1e-6);
        memset(&state, 0, sizeof state);
        state.joints = m->joints;
        state.q = m->q;
        state.qd = m->qd;
        state.intent = m->intent;
        state.programmed_override = 1.0;
        state.stamp_us = now;
        length = elbowroom_joint_state(&client, now, &state, bytes, sizeof bytes);
        send_message(c, ELBOWROOM_PUBLISH, c->joint_states, bytes, length);
        if (tick * TICK_US % SUBSCRIBE_US == 0)
            send_message(c, ELBOWROOM_SUBSCRIBE, c->speed_override, NULL, 0);
        if (tick * TICK_US % PRINT_US == 0)
            print_state(&client, m, now, began);
    }
    printf("%lu ticks, %u answers refused\n", (unsigned long)ticks, refused);
}

int main(int count, char **arguments)
{
    connection c;
    motion m;
    uint64_t configuration;
    memset(&c, 0, sizeof c);
    memset(&m, 0, sizeof m);
    if (count != 8 && count != 9) {
        fprintf(stderr, "usage: %s HOST PORT CELL ROBOT SECONDS FROM TO [CHECKSUM]\n", arguments[0]);
        return 2;
    }
    configuration = count == 9 ? parse_checksum(arguments[8]) : 0;
    if (count == 9 && configuration == 0) {
        fprintf(stderr, "CHECKSUM: the 16 digits that the service prints at its start\n");
        return 2;
    }
    m.joints = parse_joints(arguments[6], m.from);
    if (m.joints == 0 || parse_joints(arguments[7], m.to) != m.joints) {
        fprintf(stderr, "FROM and TO: one number per joint, with commas between them, at most %d\n", ELBOWROOM_MAX_JOINTS);
        return 2;
    }
    if (!open_connection(&c, arguments[1], arguments[2], arguments[3], arguments[4])) {
        fprintf(stderr, "%s:%s is no address of a node, or the names are too long\n", arguments[1], arguments[2]);
        return 1;
    }
    drive(&c, &m, atof(arguments[5]), configuration);
    close(c.socket);
    return 0;
}
