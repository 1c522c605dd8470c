// librigcal as C: for other languages. C++ has it as values in rigcal/client.h, Python in the package rigcal.
//
// Poses: p_a = T_a_b * p_b; metres; q_xyzw Hamilton, x y z w. Matrices row by row, order [x y z rx ry rz] in m and rad,
// right perturbation T * Exp(xi): the axes are those of frame b. Text is UTF-8.
//
// A function that gives an int gives RIGCAL_GOOD or one of the codes below; then rigcal_error() is one sentence that
// names what is wrong and its cure. Strings and arrays that come out belong to the client or calibration they came
// from, until the next call on it. A client, and what follows robots through it, is used by one thread at a time;
// several clients may run side by side.
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RIGCAL_API __attribute__((visibility("default")))

enum {
  RIGCAL_GOOD = 0,
  RIGCAL_INVALID_INPUT = 1,  // what was given is wrong
  RIGCAL_NOT_FOUND = 2,
  RIGCAL_CONFLICT = 3,  // it contradicts what is stored, or nobody has approved it
  RIGCAL_BUSY = 4,
  RIGCAL_UNREACHABLE = 5,  // no server answers
  RIGCAL_UNSUPPORTED = 6,
  RIGCAL_STORAGE = 7,
  RIGCAL_INTERNAL = 8
};

typedef struct rigcal_client rigcal_client;
typedef struct rigcal_follower rigcal_follower;

// Where the server is. `domain` and `tag`: of DDS; RIGCAL_DOMAIN overrules the first, RIGCAL_DDS_TAG stands for a tag
// that is NULL. `timeout_s`: how long a question waits for its answer; 0: 5 s.
typedef struct {
  int domain;
  const char* tag;
  double timeout_s;
} rigcal_options;

// `known` 0: a direction of it was not measured, and all numbers are 0; rigcal_text() has what was measured.
typedef struct {
  int known;
  double p_m[3];
  double q_xyzw[4];
  double covariance[36];
} rigcal_pose;

// What a revision is worth: "pass", "warn", "fail" or "unknown", and its drive rule ("OK to drive until 20 Feb 2027").
typedef struct {
  int64_t revision;
  const char* verdict;
  const char* drive_rule;
} rigcal_standing;

typedef struct {
  const char* frame_a;
  const char* frame_b;
  double p_m[3];
  double q_xyzw[4];
  double covariance[36];    // positive definite; all 0 where `information` is told instead
  double information[36];   // may be singular
  int dof;                  // behind the uncertainty; 0: known exactly
  const char* method;       // a name; NULL: "given"
  const char* measured_at;  // ISO 8601; NULL: not told
} rigcal_edge;

// NULL in place of options: wait for the result, give up after 60 s without any answer.
typedef struct {
  int no_wait;            // end when all is on the server's disk
  int new_robot;          // the name is right, though it is one slip away from a known robot's
  double give_up_s;       // without any answer; 0: 60 s
  const char* remounted;  // of a session: sensors that were moved on purpose, with commas between; NULL: none
} rigcal_push_options;

// What became of a push. `id`: of the session or batch. `standing.revision` 0: there is no result, or it was not waited
// for.
typedef struct {
  const char* id;
  int64_t items;        // files or edges
  int64_t total;        // bytes or edges
  int64_t held_before;  // of them, on the server's disk before
  rigcal_standing standing;
  const char* remarks;  // for people, a sentence a line: what was stored, and what looks odd in it
} rigcal_push_result;

typedef struct {
  const char* sensor;
  rigcal_pose T_ref_sensor;
} rigcal_sensor;

// The calibration that is in use; `revision` 0: none is, and the robot is not to go by any. `digest`: sha256 of
// rigcal_text().
typedef struct {
  int64_t revision;
  const char* digest;
  const char* reference;
  size_t sensor_count;
  const rigcal_sensor* sensors;  // sorted as the server's document
} rigcal_calibration;

// The library's version, "0.2.0".
RIGCAL_API const char* rigcal_version(void);

// Does not wait for a server. Never NULL: where DDS does not start, every call on it gives that error. `options` NULL:
// domain 0, 5 s.
RIGCAL_API rigcal_client* rigcal_open(const rigcal_options* options);
// After all that follows through it was closed. NULL does nothing.
RIGCAL_API void rigcal_close(rigcal_client* client);
// The sentence of the last call that failed; empty if none did.
RIGCAL_API const char* rigcal_error(const rigcal_client* client);
// The JSON document behind the last call that was good, as docs/api.md has it.
RIGCAL_API const char* rigcal_text(const rigcal_client* client);

// Any question or order of docs/api.md; the answer is rigcal_text(). `json`: its parameters; NULL: none.
RIGCAL_API int rigcal_ask(rigcal_client* client, const char* verb, const char* json);
// The pose of sensor b in sensor a. `revision` 0: of the one that is in use. RIGCAL_CONFLICT where none is. `standing`
// may be NULL.
RIGCAL_API int rigcal_lookup(rigcal_client* client, const char* robot, const char* a, const char* b, int64_t revision,
                             rigcal_pose* T_a_b, rigcal_standing* standing);

// Sends a session folder (docs/session-format.md), as `rigcal push` does: broken off, the same call goes on where it
// was, and again it changes nothing. The text is that of `rigcal push --json`.
RIGCAL_API int rigcal_push_session(rigcal_client* client, const char* folder, const rigcal_push_options* options,
                                   rigcal_push_result* result);
// Sends finished edges, likewise. All of a robot's in one call are one batch.
RIGCAL_API int rigcal_push_edges(rigcal_client* client, const char* robot, const rigcal_edge* edges, size_t count,
                                 const rigcal_push_options* options, rigcal_push_result* result);
// The same of a document of docs/edges-format.md, which has more members.
RIGCAL_API int rigcal_push_edge_document(rigcal_client* client, const char* robot, const char* json,
                                         const rigcal_push_options* options, rigcal_push_result* result);

// Follows the calibration that `robot` is to use. NULL: rigcal_error() says why.
RIGCAL_API rigcal_follower* rigcal_follow(rigcal_client* client, const char* robot);
// At first what is in use now, later each change of it, within `timeout_s`; `news` is 0 where nothing changed. After an
// error what was told last still holds: call again, also where the server was away.
RIGCAL_API int rigcal_next(rigcal_follower* follower, double timeout_s, rigcal_calibration* calibration, int* news);
// NULL does nothing.
RIGCAL_API void rigcal_unfollow(rigcal_follower* follower);

#ifdef __cplusplus
}
#endif
