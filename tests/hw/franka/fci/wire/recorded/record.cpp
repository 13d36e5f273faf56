// Writes the exchanges of one version of the protocol as the public headers lay them out:
//   g++ -std=c++17 -DVERSION=10 -I libfranka-common/include record.cpp && ./a.out > version_10.bin
// Each field has numbers of its own, which tests/hw/franka/fci/wire/test_recorded_exchanges.py
// computes from its name. The file: four sizes (u32), then requests, answers, state, command.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>
#include <research_interface/robot/rbk_types.h>
#include <research_interface/robot/service_types.h>

using namespace research_interface::robot;
using Bytes = std::vector<uint8_t>;

double number(const std::string& name, size_t index) {
  uint32_t sum = 0;
  for (size_t i = 0; i < name.size(); ++i) sum += (i + 1) * static_cast<uint8_t>(name[i]);
  return sum % 4096 + index / 32.0;  // exact in single precision
}

template <typename T>
void put(const char* name, T& field, size_t index = 0) {
  if constexpr (std::is_class_v<T>) {  // an array, or an array of arrays of three
    for (auto& part : field) {
      put(name, part, index);
      index += sizeof part == 3 * sizeof(float) ? 3 : 1;
    }
  } else if constexpr (std::is_same_v<T, bool>) {
    field = static_cast<int>(number(name, index) * 32) % 3 == 0;
  } else {
    field = static_cast<T>(number(name, index));
  }
}
template <size_t N>
std::array<double, N> doubles(const char* name) {
  std::array<double, N> made;
  put(name, made);
  return made;
}
double one(const char* name) { return number(name, 0); }
bool flag(const char* name) { bool made; put(name, made); return made; }

template <typename Service, typename Body>
void add(Bytes& stream, uint32_t id, const Body& body, const std::string& tail = "") {
  const size_t size = std::is_empty_v<Body> ? 0 : sizeof(Body);
  CommandHeader header(Service::kCommand, id, sizeof(CommandHeader) + size + tail.size());
  const auto* head = reinterpret_cast<const uint8_t*>(&header);
  const auto* data = reinterpret_cast<const uint8_t*>(&body);
  stream.insert(stream.end(), head, head + sizeof header);
  stream.insert(stream.end(), data, data + size);
  stream.insert(stream.end(), tail.begin(), tail.end());
}
struct Status { uint8_t status; };
template <typename Service>
void answer(Bytes& stream, uint32_t id, typename Service::Status status, const std::string& tail = "") {
  add<Service>(stream, id, Status{static_cast<uint8_t>(status)}, tail);
}

#define PUT(field) put(#field, s.field)
#define D(n, field) doubles<n>(#field)

Bytes state() {
  RobotState s{};
  s.message_id = 4711;
  PUT(O_T_EE); PUT(O_T_EE_d); PUT(F_T_EE); PUT(EE_T_K); PUT(F_T_NE); PUT(NE_T_EE);
  PUT(m_ee); PUT(I_ee); PUT(F_x_Cee); PUT(m_load); PUT(I_load); PUT(F_x_Cload);
  PUT(elbow); PUT(elbow_d); PUT(tau_J); PUT(tau_J_d); PUT(dtau_J); PUT(q); PUT(q_d);
  PUT(dq); PUT(dq_d); PUT(ddq_d); PUT(joint_contact); PUT(cartesian_contact);
  PUT(joint_collision); PUT(cartesian_collision); PUT(tau_ext_hat_filtered);
  PUT(O_F_ext_hat_K); PUT(K_F_ext_hat_K); PUT(O_dP_EE_d); PUT(O_ddP_O); PUT(elbow_c);
  PUT(delbow_c); PUT(ddelbow_c); PUT(O_T_EE_c); PUT(O_dP_EE_c); PUT(O_ddP_EE_c);
  PUT(theta); PUT(dtheta);
#if VERSION >= 10
  PUT(accelerometer_top); PUT(accelerometer_bottom);
#endif
  s.motion_generator_mode = MotionGeneratorMode::kCartesianVelocity;
  s.controller_mode = ControllerMode::kExternalController;
  PUT(errors); PUT(reflex_reason);
  s.robot_mode = RobotMode::kReflex;
  PUT(control_command_success_rate);
  const auto* data = reinterpret_cast<const uint8_t*>(&s);
  return Bytes(data, data + sizeof s);
}

Bytes command() {
  RobotCommand whole{};
  whole.message_id = 4711;
  {
    auto& s = whole.motion;
    PUT(q_c); PUT(dq_c); PUT(O_T_EE_c); PUT(O_dP_EE_c); PUT(elbow_c);
    PUT(valid_elbow); PUT(motion_generation_finished);
  }
  auto& s = whole.control;
  PUT(tau_J_d);
#if VERSION >= 7
  PUT(torque_command_finished);
#endif
  const auto* data = reinterpret_cast<const uint8_t*>(&whole);
  return Bytes(data, data + sizeof whole);
}

int main() {
  Bytes requests, answers;
  uint32_t n = 0;
  auto setter = [&](auto service, auto body) {
    using Service = typename decltype(service)::type;
    add<Service>(requests, ++n, body);
    answer<Service>(answers, n, Service::Status::kInvalidArgumentRejected);
  };
#define SETTER(Service, ...) \
  setter(std::enable_if<true, Service>{}, typename Service::Request(__VA_ARGS__))

  add<Connect>(requests, ++n, Connect::Request(5000));
  add<Connect>(answers, n, Connect::Response(Connect::Status::kIncompatibleLibraryVersion));
  const Move::Deviation path(1.0, 2.0, 3.0), goal(4.0, 5.0, 6.0);
  const auto external = Move::ControllerMode::kExternalController;
  const auto twist = Move::MotionGeneratorMode::kCartesianVelocity;
#if VERSION >= 10
  const std::vector<double> fastest{1, 2, 3, 4, 5, 6, 7};
  add<Move>(requests, ++n, Move::Request(external, twist, path, goal, true, fastest));
#else
  add<Move>(requests, ++n, Move::Request(external, twist, path, goal));
#endif
  answer<Move>(answers, n, Move::Status::kMotionStarted);
  answer<Move>(answers, n, Move::Status::kAborted);
  add<StopMove>(requests, ++n, StopMove::Request());
  answer<StopMove>(answers, n, StopMove::Status::kAborted);
#if VERSION == 5
  add<GetCartesianLimit>(requests, ++n, GetCartesianLimit::Request(3));
  add<GetCartesianLimit>(answers, n, GetCartesianLimit::Response(
      GetCartesianLimit::Status::kSuccess, D(3, object_world_size), D(16, object_frame),
      flag("object_activation")));
#endif
  SETTER(SetCollisionBehavior, D(7, lower_torque_thresholds_acceleration),
         D(7, upper_torque_thresholds_acceleration), D(7, lower_torque_thresholds_nominal),
         D(7, upper_torque_thresholds_nominal), D(6, lower_force_thresholds_acceleration),
         D(6, upper_force_thresholds_acceleration), D(6, lower_force_thresholds_nominal),
         D(6, upper_force_thresholds_nominal));
  SETTER(SetJointImpedance, D(7, K_theta));
  SETTER(SetCartesianImpedance, D(6, K_x));
  std::array<bool, 6> axes;
  put("guiding_mode", axes);
  SETTER(SetGuidingMode, axes, flag("nullspace"));
  SETTER(SetEEToK, D(16, EE_T_K));
  SETTER(SetNEToEE, D(16, NE_T_EE));
  SETTER(SetLoad, one("m_load"), D(3, F_x_Cload), D(9, I_load));
#if VERSION == 5
  SETTER(SetFilters, one("joint_position_filter_frequency"),
         one("joint_velocity_filter_frequency"), one("cartesian_position_filter_frequency"),
         one("cartesian_velocity_filter_frequency"), one("controller_filter_frequency"));
#endif
  add<AutomaticErrorRecovery>(requests, ++n, AutomaticErrorRecovery::Request());
  answer<AutomaticErrorRecovery>(answers, n, AutomaticErrorRecovery::Status::kAborted);
#if VERSION < 10
  using Library = LoadModelLibrary;
  add<Library>(requests, ++n, Library::Request(Library::Architecture::kARM64, Library::System::kWindows));
  answer<Library>(answers, n, Library::Status::kSuccess, "\x7f" "ELF");
#endif
#if VERSION >= 8
  add<GetRobotModel>(requests, ++n, GetRobotModel::Request());
  answer<GetRobotModel>(answers, n, GetRobotModel::Status::kSuccess, "<robot/>");
#endif
  const std::array<Bytes, 4> parts{requests, answers, state(), command()};
  for (const Bytes& part : parts) {
    const uint32_t size = part.size();
    std::fwrite(&size, sizeof size, 1, stdout);
  }
  for (const Bytes& part : parts) std::fwrite(part.data(), 1, part.size(), stdout);
}
