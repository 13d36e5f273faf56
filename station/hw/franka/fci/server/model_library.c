/* The model of an arm under the names and signatures that libfranka asks for.
 *
 * What is in front of this file, written by model_library.py, are the numbers of one
 * arm: CHAIN (a, d, cos alpha, sin alpha of joints 1 to 7 and of the flange), MASS,
 * CENTER and INERTIA of its links (about their centres of mass, in the frames of the
 * links). Matrices are column-major: T[4 c + r], J[6 c + r].
 *
 * Source of names and signatures: libfranka@0.9.2 test/model_library_interface.h.
 */
#include <math.h>
#include <string.h>

#define DOF 7
#define FLANGE 7

typedef double Vec[3];

static void cross(const Vec a, const Vec b, Vec c) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const Vec a, const Vec b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void identity(double T[16]) {
  memset(T, 0, 16 * sizeof(double));
  T[0] = T[5] = T[10] = T[15] = 1.0;
}

static void multiply(const double A[16], const double B[16], double C[16]) {
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) {
      double sum = 0.0;
      for (int k = 0; k < 4; ++k) sum += A[4 * k + r] * B[4 * c + k];
      C[4 * c + r] = sum;
    }
}

/* Poses of links 1 to 7 and of the flange: each is turned by alpha about x and moved
 * by a along x, then turned by q about z and moved by d along z (Craig's convention). */
static void place(const double q[DOF], double T[DOF + 1][16]) {
  double from[16];
  identity(from);
  for (int i = 0; i <= DOF; ++i) {
    const double a = CHAIN[i][0], d = CHAIN[i][1];
    const double ca = CHAIN[i][2], sa = CHAIN[i][3];
    const double ct = i < DOF ? cos(q[i]) : 1.0, st = i < DOF ? sin(q[i]) : 0.0;
    const double step[16] = {ct,      st * ca, st * sa, 0.0, -st, ct * ca, ct * sa, 0.0,
                             0.0,     -sa,     ca,      0.0, a,   -sa * d, ca * d,  1.0};
    multiply(from, step, T[i]);
    memcpy(from, T[i], sizeof(from));
  }
}

/* Bodies in the axes of the base: the load is a part of the last link. */
typedef struct {
  double mass;
  Vec center;       /* from the origin of the base */
  double inertia[9]; /* about the centre */
} Body;

/* I += m (|r|^2 E - r r^T) */
static void add_moved(double I[9], double m, const Vec r) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      I[3 * i + j] += m * ((i == j ? dot(r, r) : 0.0) - r[i] * r[j]);
}

static void to_base(const double T[16], Body* body) {
  Vec c;
  double I[9];
  memcpy(c, body->center, sizeof(c));
  memcpy(I, body->inertia, sizeof(I));
  for (int r = 0; r < 3; ++r) {
    body->center[r] = T[12 + r] + T[r] * c[0] + T[4 + r] * c[1] + T[8 + r] * c[2];
    for (int s = 0; s < 3; ++s) {
      double sum = 0.0;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) sum += T[4 * i + r] * I[3 * i + j] * T[4 * j + s];
      body->inertia[3 * r + s] = sum;
    }
  }
}

static void weigh(const double T[DOF + 1][16], const double I_load[9], double m_load,
                  const double F_x_Cload[3], Body bodies[DOF]) {
  for (int i = 0; i < DOF; ++i) {
    bodies[i].mass = MASS[i];
    memcpy(bodies[i].center, CENTER[i], sizeof(Vec));
    memcpy(bodies[i].inertia, INERTIA[i], 9 * sizeof(double));
  }
  Body* last = &bodies[DOF - 1];
  const double total = last->mass + m_load;
  if (m_load != 0.0 && total != 0.0) {
    /* The flange has the axes of link 7, and is moved along z. */
    const Vec load = {F_x_Cload[0], F_x_Cload[1], F_x_Cload[2] + CHAIN[FLANGE][1]};
    Vec joint, from_link, from_load;
    for (int r = 0; r < 3; ++r) {
      joint[r] = (last->mass * last->center[r] + m_load * load[r]) / total;
      from_link[r] = last->center[r] - joint[r];
      from_load[r] = load[r] - joint[r];
    }
    add_moved(last->inertia, last->mass, from_link);
    add_moved(last->inertia, m_load, from_load);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        last->inertia[3 * i + j] += 0.5 * (I_load[3 * i + j] + I_load[3 * j + i]);
    memcpy(last->center, joint, sizeof(joint));
    last->mass = total;
  }
  for (int i = 0; i < DOF; ++i) to_base(T[i], &bodies[i]);
}

/* Force through the centre and moment about it that a body with the acceleration
 * `linear` of its centre, `angular`, and the angular velocity `w` needs. */
static void push(const Body* body, const Vec linear, const Vec angular, const Vec w,
                 Vec force, Vec moment) {
  Vec spin = {0.0, 0.0, 0.0}, gyro;
  for (int r = 0; r < 3; ++r) {
    force[r] = body->mass * linear[r];
    moment[r] = 0.0;
    for (int c = 0; c < 3; ++c) {
      moment[r] += body->inertia[3 * r + c] * angular[c];
      spin[r] += body->inertia[3 * r + c] * w[c];
    }
  }
  cross(w, spin, gyro);
  for (int r = 0; r < 3; ++r) moment[r] += gyro[r];
}

/* Newton-Euler: the torques of velocities dq and accelerations ddq, with the base
 * accelerated by `base`. */
static void newton_euler(const double T[DOF + 1][16], const Body bodies[DOF],
                         const double dq[DOF], const double ddq[DOF], const Vec base,
                         double tau[DOF]) {
  Vec w = {0.0, 0.0, 0.0}, dw = {0.0, 0.0, 0.0}, a, before = {0.0, 0.0, 0.0};
  Vec forces[DOF], moments[DOF];
  memcpy(a, base, sizeof(Vec));
  for (int i = 0; i < DOF; ++i) {
    const double* origin = &T[i][12];
    const double* axis = &T[i][8];
    Vec r, u, v, s, t;
    for (int k = 0; k < 3; ++k) r[k] = origin[k] - before[k];
    cross(dw, r, u);
    cross(w, r, s);
    cross(w, s, v);
    for (int k = 0; k < 3; ++k) a[k] += u[k] + v[k];
    for (int k = 0; k < 3; ++k) s[k] = dq[i] * axis[k];
    cross(w, s, t);
    for (int k = 0; k < 3; ++k) {
      dw[k] += ddq[i] * axis[k] + t[k];
      w[k] += s[k];
      before[k] = origin[k];
      r[k] = bodies[i].center[k] - origin[k];
    }
    Vec linear;
    cross(dw, r, u);
    cross(w, r, s);
    cross(w, s, v);
    for (int k = 0; k < 3; ++k) linear[k] = a[k] + u[k] + v[k];
    push(&bodies[i], linear, dw, w, forces[i], moments[i]);
  }
  for (int j = 0; j < DOF; ++j) {
    tau[j] = 0.0;
    for (int i = j; i < DOF; ++i) {
      Vec r, u;
      for (int k = 0; k < 3; ++k) r[k] = bodies[i].center[k] - T[j][12 + k];
      cross(r, forces[i], u);
      for (int k = 0; k < 3; ++k) u[k] += moments[i][k];
      tau[j] += dot(&T[j][8], u);
    }
  }
}

void M_NE(const double q[7], const double I_load[9], double m_load,
          const double F_x_Cload[3], double M[49]) {
  const Vec rest = {0.0, 0.0, 0.0};
  const double still[DOF] = {0.0};
  double T[DOF + 1][16], ddq[DOF] = {0.0};
  Body bodies[DOF];
  place(q, T);
  weigh(T, I_load, m_load, F_x_Cload, bodies);
  for (int c = 0; c < DOF; ++c) {
    ddq[c] = 1.0;
    newton_euler(T, bodies, still, ddq, rest, &M[DOF * c]);
    ddq[c] = 0.0;
  }
}

void c_NE(const double q[7], const double dq[7], const double I_load[9], double m_load,
          const double F_x_Cload[3], double c[7]) {
  const Vec rest = {0.0, 0.0, 0.0};
  const double still[DOF] = {0.0};
  double T[DOF + 1][16];
  Body bodies[DOF];
  place(q, T);
  weigh(T, I_load, m_load, F_x_Cload, bodies);
  newton_euler(T, bodies, dq, still, rest, c);
}

void g_NE(const double q[7], const double g_earth[3], double m_load,
          const double F_x_Cload[3], double g[7]) {
  const Vec up = {-g_earth[0], -g_earth[1], -g_earth[2]};
  const double still[DOF] = {0.0}, none[9] = {0.0};
  double T[DOF + 1][16];
  Body bodies[DOF];
  place(q, T);
  weigh(T, none, m_load, F_x_Cload, bodies);
  newton_euler(T, bodies, still, still, up, g);
}

/* The Jacobian of a pose that the first `count` joints move, in the axes of the base,
 * or in those of the pose. */
static void jacobian(const double T[DOF + 1][16], const double pose[16], int count,
                     int is_body, double J[42]) {
  memset(J, 0, 42 * sizeof(double));
  for (int c = 0; c < count; ++c) {
    Vec r, parts[2];
    for (int k = 0; k < 3; ++k) r[k] = pose[12 + k] - T[c][12 + k];
    cross(&T[c][8], r, parts[0]);
    memcpy(parts[1], &T[c][8], sizeof(Vec));
    for (int part = 0; part < 2; ++part)
      for (int k = 0; k < 3; ++k)
        J[6 * c + 3 * part + k] = is_body ? dot(&pose[4 * k], parts[part]) : parts[part][k];
  }
}

#define FRAME(NUMBER)                                 \
  void O_T_J##NUMBER(const double q[7], double result[16]) { \
    double T[DOF + 1][16];                                   \
    place(q, T);                                             \
    memcpy(result, T[NUMBER - 1], 16 * sizeof(double));      \
  }

#define JACOBIANS(NUMBER, COUNT)                                \
  void O_J_J##NUMBER(const double q[7], double result[42]) {    \
    double T[DOF + 1][16];                                      \
    place(q, T);                                                \
    jacobian(T, T[NUMBER - 1], COUNT, 0, result);               \
  }                                                             \
  void Ji_J_J##NUMBER(const double q[7], double result[42]) {   \
    double T[DOF + 1][16];                                      \
    place(q, T);                                                \
    jacobian(T, T[NUMBER - 1], COUNT, 1, result);               \
  }

FRAME(1)
FRAME(2)
FRAME(3)
FRAME(4)
FRAME(5)
FRAME(6)
FRAME(7)
FRAME(8)
JACOBIANS(2, 2)
JACOBIANS(3, 3)
JACOBIANS(4, 4)
JACOBIANS(5, 5)
JACOBIANS(6, 6)
JACOBIANS(7, 7)
JACOBIANS(8, 7)

/* The first joint turns its own frame about z, wherever it is. */
void O_J_J1(double result[42]) {
  memset(result, 0, 42 * sizeof(double));
  result[5] = 1.0;
}

void Ji_J_J1(double result[42]) { O_J_J1(result); }

void O_T_J9(const double q[7], const double F_T_EE[16], double result[16]) {
  double T[DOF + 1][16];
  place(q, T);
  multiply(T[FLANGE], F_T_EE, result);
}

void O_J_J9(const double q[7], const double F_T_EE[16], double result[42]) {
  double T[DOF + 1][16], pose[16];
  place(q, T);
  multiply(T[FLANGE], F_T_EE, pose);
  jacobian(T, pose, DOF, 0, result);
}

void Ji_J_J9(const double q[7], const double F_T_EE[16], double result[42]) {
  double T[DOF + 1][16], pose[16];
  place(q, T);
  multiply(T[FLANGE], F_T_EE, pose);
  jacobian(T, pose, DOF, 1, result);
}
