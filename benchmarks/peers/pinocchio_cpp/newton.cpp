// Newton for an equilibrium with Pinocchio's C++ kernels: one iteration is `computeJointJacobians`, the load's stiffness
// from `data.J`, and one solve. `newton CASES NAME` prints JSON as every engine of the comparison does.
//
// Two ways to solve: dense LU, as for any load, and forward substitution, since under a force on a line fixed in space
// the tangent is lower triangular. No memory is allocated while the clock runs.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <boost/property_tree/json_parser.hpp>
#include <boost/property_tree/ptree.hpp>

#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/multibody.hpp>

namespace pin = pinocchio;
using Tree = boost::property_tree::ptree;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// As many Newton steps as this go nowhere.
constexpr int most_steps = 60;
/// What Newton leaves after a step so short is rounding.
constexpr double last_step_rad = 1e-7;

static std::vector<double> numbers(const Tree &tree) {
  std::vector<double> values;
  for (const auto &[key, value] : tree) values.push_back(value.get_value<double>());
  return values;
}

static Vector3d vector(const Tree &tree) {
  const auto values = numbers(tree);
  return {values[0], values[1], values[2]};
}

struct Spine {
  pin::Model model;
  std::vector<pin::FrameIndex> frames;  // at the midpoints of L3…T2
  Vector3d base;                        // L4's midpoint
  VectorXd stiffness;                   // of all hinges
  std::vector<Vector6d> wrenches;       // per bend: force, then moment about the origin, as Pinocchio has them
};

static Spine build(const Tree &given) {
  std::vector<Vector3d> midpoints;
  std::vector<Matrix3d> axes;
  for (const auto &[key, vertebra] : given.get_child("vertebrae")) {
    midpoints.push_back(vector(vertebra.get_child("midpoint_mm")));
    Matrix3d rotation;
    int row = 0;
    for (const auto &[none, values] : vertebra.get_child("axes")) rotation.row(row++) = vector(values);
    axes.push_back(rotation);
  }
  const auto multipliers = numbers(given.get_child("multipliers"));
  Spine spine;
  spine.base = midpoints[0];
  spine.stiffness.resize(3 * (midpoints.size() - 1));
  pin::JointIndex parent = 0;
  pin::SE3 onto(axes[0], midpoints[0]);
  int j = 0;
  for (const auto &[key, joint] : given.get_child("joints")) {
    const Matrix3d into = axes[j].transpose();
    const Vector3d centre = vector(joint.get_child("centre_mm"));
    const pin::SE3 placement = onto * pin::SE3(Matrix3d::Identity(), into * (centre - midpoints[j]));
    const std::string name = std::to_string(j);
    parent = spine.model.addJoint(parent, pin::JointModelRX(), placement, name + "x");
    parent = spine.model.addJoint(parent, pin::JointModelRY(), pin::SE3::Identity(), name + "y");
    parent = spine.model.addJoint(parent, pin::JointModelRZ(), pin::SE3::Identity(), name + "z");
    onto = pin::SE3(into * axes[j + 1], into * (midpoints[j + 1] - centre));
    spine.frames.push_back(spine.model.addFrame(pin::Frame("vertebra" + name, parent, onto, pin::OP_FRAME)));
    Vector3d stiffness = vector(joint.get_child("stiffness_nmm_per_rad"));
    stiffness.x() *= multipliers[joint.get<int>("region")];
    spine.stiffness.segment<3>(3 * j++) = stiffness;
  }
  for (const auto &[key, bend] : given.get_child("bends")) {
    const Vector3d point = vector(bend.get_child("point_mm"));
    const Vector3d force = vector(bend.get_child("direction")) * bend.get<double>("force_n");
    Vector6d wrench;
    wrench << force, point.cross(force);
    spine.wrenches.push_back(wrench);
  }
  return spine;
}

enum class Solve { dense, triangular };

class Newton {
 public:
  Newton(const Spine &spine, Solve solve)
      : spine_(spine), data_(spine.model), solve_(solve), lu_(spine.model.nv), tangent_(spine.model.nv, spine.model.nv),
        residual_(spine.model.nv), swept_(6, spine.model.nv) {}

  /// Hinge angles in equilibrium, in place of the start; whether Newton got there.
  bool equilibrium(const Vector6d &wrench, VectorXd &q) {
    // Hinge k moves the screws of every hinge i above it: (J_k × J_i)·w = J_iᵀ X J_k, with X of the wrench alone.
    const Matrix3d force = pin::skew(Vector3d(wrench.head<3>())), moment = pin::skew(Vector3d(wrench.tail<3>()));
    Matrix6d rate;
    rate << Matrix3d::Zero(), force, force, moment;
    for (int step = 0; step < most_steps; ++step) {
      pin::computeJointJacobians(spine_.model, data_, q);
      residual_.noalias() = data_.J.transpose() * -wrench;
      residual_ += spine_.stiffness.cwiseProduct(q);
      swept_.noalias() = -rate * data_.J;
      tangent_.noalias() = data_.J.transpose() * swept_;
      tangent_.triangularView<Eigen::StrictlyUpper>().setZero();
      tangent_.diagonal() = spine_.stiffness;
      if (solve_ == Solve::triangular) {
        tangent_.triangularView<Eigen::Lower>().solveInPlace(residual_);
      } else {
        lu_.compute(tangent_);
        residual_ = lu_.solve(residual_);
      }
      q -= residual_;
      if (residual_.lpNorm<Eigen::Infinity>() < last_step_rad) return true;
    }
    return false;
  }

  std::vector<Vector3d> midpoints(const VectorXd &q) {
    pin::framesForwardKinematics(spine_.model, data_, q);
    std::vector<Vector3d> places{spine_.base};
    for (const auto frame : spine_.frames) places.push_back(data_.oMf[frame].translation());
    return places;
  }

 private:
  const Spine &spine_;
  pin::Data data_;
  Solve solve_;
  Eigen::PartialPivLU<MatrixXd> lu_;
  MatrixXd tangent_;
  VectorXd residual_;
  pin::Data::Matrix6x swept_;
};

/// Median time of one equilibrium, over both bends.
static double median_seconds(Newton &newton, const Spine &spine, const std::vector<VectorXd> &starts) {
  using Clock = std::chrono::steady_clock;
  constexpr int samples = 1000, calls = 10;
  VectorXd q = starts[0];
  std::vector<double> means;
  for (int sample = 0; sample < samples; ++sample) {
    const auto start = Clock::now();
    for (int call = 0; call < calls; ++call) {
      q = starts[call % 2];
      newton.equilibrium(spine.wrenches[call % 2], q);
    }
    means.push_back(std::chrono::duration<double>(Clock::now() - start).count() / calls);
  }
  std::sort(means.begin(), means.end());
  return means[samples / 2];
}

static void print_row(const Spine &spine, Solve solve, bool near, bool first) {
  Newton newton(spine, solve);
  std::vector<VectorXd> starts;
  const char *method = solve == Solve::dense ? "usual: Newton, dense LU" : "tuned: Newton, triangular solve";
  std::printf("%s{\"task\": \"%s\", \"method\": \"%s\", ", first ? "" : ", ", near ? "equilibrium_near" : "equilibrium", method);
  std::printf("\"midpoints_mm\": [");
  for (const auto &wrench : spine.wrenches) {
    starts.push_back(VectorXd::Zero(spine.model.nq));
    if (near) newton.equilibrium(0.95 * wrench, starts.back());
    VectorXd q = starts.back();
    newton.equilibrium(wrench, q);
    std::printf("%s[", starts.size() > 1 ? ", " : "");
    const auto places = newton.midpoints(q);
    for (const auto &place : places)
      std::printf("%s[%.17g, %.17g, %.17g]", &place == &places.front() ? "" : ", ", place.x(), place.y(), place.z());
    std::printf("]");
  }
  std::printf("], \"seconds\": %.6g}", median_seconds(newton, spine, starts));
}

int main(int count, char **arguments) {
  if (count != 3) {
    std::fprintf(stderr, "newton CASES NAME\n");
    return 2;
  }
  Tree file;
  boost::property_tree::read_json(arguments[1], file);
  for (const auto &[key, given] : file.get_child("cases")) {
    if (given.get<std::string>("name") != arguments[2]) continue;
    const Spine spine = build(given);
    std::printf("{\"engine\": \"pinocchio C++\", \"version\": \"%s\", \"case\": \"%s\", \"cannot\": [\"as pinocchio\"], \"rows\": [",
                PINOCCHIO_VERSION, arguments[2]);
    for (const Solve solve : {Solve::dense, Solve::triangular})
      for (const bool near : {false, true}) print_row(spine, solve, near, solve == Solve::dense && !near);
    std::printf("]}\n");
    return 0;
  }
  std::fprintf(stderr, "newton: unknown case\n");
  return 1;
}
