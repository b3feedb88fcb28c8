/*
 * The controller's side of an elbowroom node, in C99: makes the bytes of a tick, reads the node's answers, and says which speed
 * override to apply. docs/live.md has the bytes.
 *
 * One header, no allocation, no dependency, no input or output: call it from any loop, and send the bytes by any network.
 * elbowroom_datagram and elbowroom_contents are the frame of UDP datagrams; example.c beside this file is a whole controller.
 *
 *     elbowroom_client client;
 *     elbowroom_client_init(&client, time_of_day_ns, 0, 20000);
 *     every tick:
 *         apply elbowroom_speed_override(&client, now_us);
 *         length = elbowroom_joint_state(&client, now_us, &state, bytes, sizeof bytes);    and send them
 *     for every answer that arrives:
 *         elbowroom_receive(&client, bytes, length);
 *
 * It stops by itself: an answer counts for stale_us from the moment at which the joint values that it answers were sent, on the
 * controller's own clock. So the override is 0 at most that long after the last joint values that a living node has seen. The clock
 * must never go back, nor stand still while the computer is suspended: CLOCK_BOOTTIME on Linux.
 *
 * Not a certified safety device: use it beside the safety functions of the controller, never in their place.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef ELBOWROOM_CLIENT_H
#define ELBOWROOM_CLIENT_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Most joints and most attached volumes of a message. */
#define ELBOWROOM_MAX_JOINTS 32
#define ELBOWROOM_MAX_ATTACHED 16
/* Lengths of the longest joint state, of an answer, and of the frame of a datagram. */
#define ELBOWROOM_JOINT_STATE_BYTES (8 + 44 + 3 * 8 * ELBOWROOM_MAX_JOINTS + 58 * ELBOWROOM_MAX_ATTACHED)
#define ELBOWROOM_ANSWER_BYTES 60
#define ELBOWROOM_FRAME_BYTES (5 + 255)
/* The times at which this many messages were sent are remembered: answers to older ones are too old anyway. */
#define ELBOWROOM_REMEMBERED 256

/* What an answer may be: obeyed, or why not. */
#define ELBOWROOM_OBEYED 0
#define ELBOWROOM_UNREADABLE 1          /* damaged, of another kind or another version */
#define ELBOWROOM_OTHER_START 2         /* for another start of this controller */
#define ELBOWROOM_OTHER_CONFIGURATION 3 /* the node guards another cell file */
#define ELBOWROOM_LATE 4                /* late, repeated, or it answers what was not sent */
#define ELBOWROOM_NO_OVERRIDE 5         /* the override is not within 0..1 */

/* Kinds of datagrams. */
#define ELBOWROOM_SUBSCRIBE 1
#define ELBOWROOM_PUBLISH 2

/* Doubles are sent as IEEE 754 numbers of 64 bits. */
typedef char elbowroom_doubles_have_64_bits[sizeof(double) == 8 ? 1 : -1];

/* A gripped part or an exchanged tool, that is on the robot now. */
typedef struct {
    uint16_t volume;           /* its index in the node's configuration */
    double position_m[3];      /* in its link */
    double quaternion_xyzw[4]; /* in its link, of length 1 */
} elbowroom_attached;

/* What a controller reports in a tick. Arrays have one value per joint in the order of the chain, in rad or m. */
typedef struct {
    size_t joints;
    const double *q;
    const double *qd;     /* velocities; NULL where they are not known */
    const double *intent; /* velocities of the program at override 1; NULL where they are not known */
    double programmed_override; /* 0..1 */
    const elbowroom_attached *attached;
    size_t attached_count;
    uint64_t stamp_us; /* when the joints were read, on the clock of all other times */
} elbowroom_state;

/* What the node answers. */
typedef struct {
    uint64_t configuration;
    uint64_t boot;
    uint64_t echo;     /* the number that is answered */
    uint64_t sequence; /* rises with every answer */
    double speed_override;
    uint64_t outputs; /* bit i is channel i */
    uint8_t reason;   /* 0 free, 1 region, 2 speed zone, 3 waiting, 4 rate, 5 fault, 6 halted */
    uint16_t region;  /* index in the node's configuration; 65535 for none */
} elbowroom_answer;

typedef struct {
    uint64_t boot;
    uint64_t configuration;
    uint64_t stale_us;
    uint64_t sequence;
    uint64_t sent_us[ELBOWROOM_REMEMBERED];
    elbowroom_answer answer;
    int has_answer;
} elbowroom_client;

/* ---- Bytes ---- */

/* CRC-32 of IEEE 802.3, as in zlib. */
static inline uint32_t elbowroom_crc32(const uint8_t *bytes, size_t length)
{
    static const uint32_t of_nibble[16] = {
        0x00000000u, 0x1db71064u, 0x3b6e20c8u, 0x26d930acu, 0x76dc4190u, 0x6b6b51f4u, 0x4db26158u, 0x5005713cu,
        0xedb88320u, 0xf00f9344u, 0xd6d6a3e8u, 0xcb61b38cu, 0x9b64c2b0u, 0x86d3d2d4u, 0xa00ae278u, 0xbdbdf21cu,
    };
    uint32_t crc = 0xffffffffu;
    size_t i;
    for (i = 0; i < length; i++) {
        crc ^= bytes[i];
        crc = (crc >> 4) ^ of_nibble[crc & 15u];
        crc = (crc >> 4) ^ of_nibble[crc & 15u];
    }
    return crc ^ 0xffffffffu;
}

/* Writes the low `count` bytes of a number, the lowest first. Returns where the next one goes. */
static inline uint8_t *elbowroom_put(uint8_t *out, uint64_t value, int count)
{
    int i;
    for (i = 0; i < count; i++)
        *out++ = (uint8_t)((value >> (8 * i)) & 0xffu);
    return out;
}

static inline uint8_t *elbowroom_put_doubles(uint8_t *out, const double *values, size_t count)
{
    size_t i;
    for (i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        out = elbowroom_put(out, bits, 8);
    }
    return out;
}

static inline uint64_t elbowroom_get(const uint8_t *bytes, int count)
{
    uint64_t value = 0;
    int i;
    for (i = count - 1; i >= 0; i--)
        value = value << 8 | bytes[i];
    return value;
}

static inline double elbowroom_get_double(const uint8_t *bytes)
{
    uint64_t bits = elbowroom_get(bytes, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* ---- The client ---- */

/* `boot` must be higher than at former starts of this controller: the time of day in nanoseconds will do. `configuration` is
   the number of the cell file, or 0 to obey any: a node with exchange regions refuses 0. `stale_us` is stale_ms of the cell file
   (20 ms without one), in µs. */
static inline void elbowroom_client_init(elbowroom_client *client, uint64_t boot, uint64_t configuration, uint64_t stale_us)
{
    memset(client, 0, sizeof *client);
    client->boot = boot;
    client->configuration = configuration;
    client->stale_us = stale_us;
}

static inline const elbowroom_answer *elbowroom_answer_at(const elbowroom_client *client, uint64_t now_us);

/* The bytes of the next message to the node, in every tick. While no answer counts it says that the program stands, at override 0: the
   node must not take a robot that stops by itself for one whose joint values are frozen. Returns their number; 0, and nothing is sent,
   where `capacity` is too small, or there are more joints or attached volumes than a message has. */
static inline size_t elbowroom_joint_state(elbowroom_client *client, uint64_t now_us, const elbowroom_state *state,
                                           uint8_t *out, size_t capacity)
{
    const size_t blocks = 1u + (state->qd != NULL) + (state->intent != NULL);
    const double programmed_override = elbowroom_answer_at(client, now_us) != NULL ? state->programmed_override : 0.0;
    uint8_t *at = out;
    size_t length, i;
    if (state->joints > ELBOWROOM_MAX_JOINTS || state->attached_count > ELBOWROOM_MAX_ATTACHED)
        return 0;
    length = 8 + 44 + blocks * 8 * state->joints + 58 * state->attached_count;
    if (capacity < length)
        return 0;

    client->sequence++;
    client->sent_us[client->sequence % ELBOWROOM_REMEMBERED] = now_us;
    *at++ = 'E';
    *at++ = 'L';
    *at++ = 1; /* version */
    *at++ = 1; /* kind */
    *at++ = (uint8_t)state->joints;
    *at++ = (uint8_t)((state->qd != NULL ? 1 : 0) | (state->intent != NULL ? 2 : 0));
    *at++ = (uint8_t)state->attached_count;
    *at++ = 0;
    at = elbowroom_put(at, client->configuration, 8);
    at = elbowroom_put(at, client->boot, 8);
    at = elbowroom_put(at, client->sequence, 8);
    at = elbowroom_put(at, state->stamp_us, 8);
    at = elbowroom_put_doubles(at, &programmed_override, 1);
    at = elbowroom_put_doubles(at, state->q, state->joints);
    if (state->qd != NULL)
        at = elbowroom_put_doubles(at, state->qd, state->joints);
    if (state->intent != NULL)
        at = elbowroom_put_doubles(at, state->intent, state->joints);
    for (i = 0; i < state->attached_count; i++) {
        at = elbowroom_put(at, state->attached[i].volume, 2);
        at = elbowroom_put_doubles(at, state->attached[i].position_m, 3);
        at = elbowroom_put_doubles(at, state->attached[i].quaternion_xyzw, 4);
    }
    elbowroom_put(at, elbowroom_crc32(out, length - 4), 4);
    return length;
}

/* Reads an answer; 0 where the bytes are none. */
static inline int elbowroom_read_answer(const uint8_t *bytes, size_t length, elbowroom_answer *answer)
{
    if (length != ELBOWROOM_ANSWER_BYTES || bytes[0] != 'E' || bytes[1] != 'L' || bytes[2] != 1 || bytes[3] != 2)
        return 0;
    if (elbowroom_crc32(bytes, length - 4) != elbowroom_get(bytes + length - 4, 4))
        return 0;
    answer->configuration = elbowroom_get(bytes + 4, 8);
    answer->boot = elbowroom_get(bytes + 12, 8);
    answer->echo = elbowroom_get(bytes + 20, 8);
    answer->sequence = elbowroom_get(bytes + 28, 8);
    answer->speed_override = elbowroom_get_double(bytes + 36);
    answer->outputs = elbowroom_get(bytes + 44, 8);
    answer->reason = bytes[52];
    answer->region = (uint16_t)elbowroom_get(bytes + 54, 2);
    return 1;
}

/* Takes an answer of the node. Returns ELBOWROOM_OBEYED, or why it is not: then the former one counts for as long as it is fresh. */
static inline int elbowroom_receive(elbowroom_client *client, const uint8_t *bytes, size_t length)
{
    const elbowroom_answer *last = &client->answer;
    elbowroom_answer answer;
    if (!elbowroom_read_answer(bytes, length, &answer))
        return ELBOWROOM_UNREADABLE;
    if (answer.boot != client->boot)
        return ELBOWROOM_OTHER_START;
    if (client->configuration != 0 && answer.configuration != client->configuration)
        return ELBOWROOM_OTHER_CONFIGURATION;
    if (answer.echo == 0 || answer.echo > client->sequence)
        return ELBOWROOM_LATE;
    if (client->has_answer
        && (answer.echo < last->echo || (answer.echo == last->echo && answer.sequence <= last->sequence)))
        return ELBOWROOM_LATE;
    /* Written so that NaN is refused. */
    if (!(answer.speed_override >= 0.0 && answer.speed_override <= 1.0))
        return ELBOWROOM_NO_OVERRIDE;
    client->answer = answer;
    client->has_answer = 1;
    return ELBOWROOM_OBEYED;
}

/* The last answer, while it counts; else NULL. */
static inline const elbowroom_answer *elbowroom_answer_at(const elbowroom_client *client, uint64_t now_us)
{
    uint64_t sent_us;
    if (!client->has_answer || client->sequence - client->answer.echo >= ELBOWROOM_REMEMBERED)
        return NULL;
    sent_us = client->sent_us[client->answer.echo % ELBOWROOM_REMEMBERED];
    /* On a clock that was set back nothing is fresh. */
    if (now_us < sent_us || now_us - sent_us > client->stale_us)
        return NULL;
    return &client->answer;
}

/* The override to apply now, 0..1: 0 without an answer that counts. */
static inline double elbowroom_speed_override(const elbowroom_client *client, uint64_t now_us)
{
    const elbowroom_answer *answer = elbowroom_answer_at(client, now_us);
    return answer != NULL ? answer->speed_override : 0.0;
}

/* ---- UDP datagrams ---- */

/* Appends a name to a key, with _ in place of what a key may not have. Returns 0 where it does not fit. */
static inline int elbowroom_append(char *key, size_t capacity, const char *text, int is_name)
{
    size_t at = strlen(key);
    if (is_name && *text == '\0')
        text = "_";
    for (; *text != '\0'; text++) {
        if (at + 1 >= capacity)
            return 0;
        key[at++] = is_name && strchr("/*$?#", *text) != NULL ? '_' : *text;
    }
    key[at] = '\0';
    return 1;
}

/* The key elbowroom/CELL/ROBOT/WHAT; WHAT is "joint_states" to the node, "override" from it. Returns 0 where it does not fit. */
static inline int elbowroom_key(char *key, size_t capacity, const char *cell, const char *robot, const char *what)
{
    if (capacity == 0)
        return 0;
    key[0] = '\0';
    return elbowroom_append(key, capacity, "elbowroom/", 0) && elbowroom_append(key, capacity, cell, 1)
        && elbowroom_append(key, capacity, "/", 0) && elbowroom_append(key, capacity, robot, 1)
        && elbowroom_append(key, capacity, "/", 0) && elbowroom_append(key, capacity, what, 0);
}

/* A datagram of a message under a key. To subscribe to a key, send one of kind ELBOWROOM_SUBSCRIBE without contents each second.
   Returns its length; 0 where it does not fit. */
static inline size_t elbowroom_datagram(uint8_t kind, const char *key, const uint8_t *contents, size_t length, uint8_t *out,
                                        size_t capacity)
{
    const size_t key_length = strlen(key);
    if (key_length == 0 || key_length > 255 || capacity < 5 + key_length || capacity - 5 - key_length < length)
        return 0;
    out[0] = 'E';
    out[1] = 'U';
    out[2] = 1; /* version */
    out[3] = kind;
    out[4] = (uint8_t)key_length;
    memcpy(out + 5, key, key_length);
    if (length > 0)
        memcpy(out + 5 + key_length, contents, length);
    return 5 + key_length + length;
}

/* The contents of a datagram that was published under a key, and their length; NULL for any other one. */
static inline const uint8_t *elbowroom_contents(const uint8_t *datagram, size_t length, const char *key, size_t *contents_length)
{
    const size_t key_length = strlen(key);
    if (length < 5 + key_length || datagram[0] != 'E' || datagram[1] != 'U' || datagram[2] != 1)
        return NULL;
    if (datagram[3] != ELBOWROOM_PUBLISH || datagram[4] != key_length || memcmp(datagram + 5, key, key_length) != 0)
        return NULL;
    *contents_length = length - 5 - key_length;
    return datagram + 5 + key_length;
}

#endif
