// Opens an exported Gazebo package with Gazebo's own libraries:
//
//   open_package PACKAGE_DIR
//
// libsdformat parses the world with warnings and unknown elements as errors, the mesh and image loaders of
// ignition-common open every file it names, and ignition-physics with the DART engine, Gazebo's default, drops a ball
// on the collision meshes the way the Physics system of gz-sim builds them. The ball must lie on the triangles.
//
// The first start pose must be found as users find it: by a pose in the world relative to the frame of the model.
//
// The world must have a model for each movable thing of instances.json and for no other, of its mass and at its place, with an
// inertia that a body can have. After the four seconds of the ball nine of ten are still where they were.
//
// A package with a rover, models/<name>_rover, has it driven as DiffDrive of gz-sim does, by the velocities of its wheels: from
// spawn_0 straight ahead and back, and on level ground around. It must get as far as its wheels say.

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <ignition/common/Console.hh>
#include <ignition/common/Image.hh>
#include <ignition/common/Mesh.hh>
#include <ignition/common/MeshManager.hh>
#include <ignition/common/SubMesh.hh>
#include <ignition/math/Pose3.hh>
#include <ignition/math/eigen3/Conversions.hh>
#include <ignition/physics/FindFeatures.hh>
#include <ignition/physics/ForwardStep.hh>
#include <ignition/physics/FrameSemantics.hh>
#include <ignition/physics/GetEntities.hh>
#include <ignition/physics/Joint.hh>
#include <ignition/physics/RequestEngine.hh>
#include <ignition/physics/config.hh>
#include <ignition/physics/mesh/MeshShape.hh>
#include <ignition/physics/sdf/ConstructCollision.hh>
#include <ignition/physics/sdf/ConstructLink.hh>
#include <ignition/physics/sdf/ConstructModel.hh>
#include <ignition/physics/sdf/ConstructWorld.hh>
#include <ignition/plugin/Loader.hh>
#include <json/json.h>
#include <sdf/sdf.hh>

namespace fs = std::filesystem;
namespace common = ignition::common;
namespace physics = ignition::physics;
using ignition::math::Vector3d;

constexpr double kBallRadiusM = 0.2;
constexpr double kDropM = 0.6;
// 600 times that of a ball, kg m2: it slides to a stop instead of rolling down every slope.
constexpr double kInertia = 10.0;
constexpr std::chrono::milliseconds kStep{4};
constexpr int kSteps = 1000;
constexpr double kToleranceM = 0.03;
constexpr double kAwayM = 2.0;
constexpr double kRestMPerS = 0.05;
// A movable thing may drop by what collision shapes are behind what is seen, and move by a share of its width. DART collides
// triangles with triangles, on which stones creep more than convex bodies do: so many must stay nevertheless.
constexpr double kSettledM = 0.02;
constexpr double kMovedShare = 0.2;
constexpr double kCalmShare = 0.95;
constexpr double kPlaceM = 1e-5;
constexpr double kMassShare = 1e-3;  // masses have milligrams
constexpr std::chrono::milliseconds kRoverStep{1};
constexpr double kLiftM = 0.05;
constexpr double kSpeedMPerS = 0.5;
constexpr double kTurnRadPerS = 0.6;
constexpr double kDriveS = 2.0;
constexpr double kStandsUpright = 0.8;
// Stones and slopes slow it down and turn it; on level ground it should turn as it is told.
constexpr double kDriveShare = 0.15;
constexpr double kTurnShare = 0.15;

struct Features : physics::FeatureList<
                      physics::GetEngineInfo, physics::GetWorldFromEngine, physics::GetModelFromWorld,
                      physics::GetLinkFromModel, physics::GetJointFromModel, physics::ForwardStep,
                      physics::LinkFrameSemantics, physics::SetJointVelocityCommandFeature,
                      physics::sdf::ConstructSdfWorld, physics::sdf::ConstructSdfModel,
                      physics::sdf::ConstructSdfLink, physics::sdf::ConstructSdfCollision,
                      physics::mesh::AttachMeshShapeFeature> {};

using Triangle = std::array<Vector3d, 3>;

[[noreturn]] void Fail(const std::string &message) { throw std::runtime_error(message); }

fs::path Resolve(const std::string &uri, const fs::path &package) {
  const std::string scheme = "model://";
  if (uri.compare(0, scheme.size(), scheme) != 0) Fail("not a model:// URI: " + uri);
  return package / "models" / uri.substr(scheme.size());
}

fs::path WorldFile(const fs::path &package) {
  std::vector<fs::path> files;
  for (const auto &entry : fs::directory_iterator(package / "worlds")) files.push_back(entry.path());
  if (files.size() != 1) Fail("expected one world in " + (package / "worlds").string());
  return files.front();
}

// What Gazebo Harmonic reads although this libsdformat does not know it.
bool IsOfHarmonic(const sdf::Error &error) {
  for (const auto *known : {"[gz_frame_id], child of element[sensor]", "[optical_frame_id], child of element[camera]"})
    if (error.Message().find(known) != std::string::npos) return true;
  return false;
}

sdf::ParserConfig Strict(const fs::path &package) {
  sdf::ParserConfig config;
  config.SetWarningsPolicy(sdf::EnforcementPolicy::ERR);
  config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::ERR);
  config.SetFindCallback([package](const std::string &uri) { return Resolve(uri, package).string(); });
  return config;
}

void Require(const sdf::Errors &errors) {
  std::string faults;
  for (const auto &error : errors)
    if (!IsOfHarmonic(error)) faults += "\n  " + error.Message();
  if (!faults.empty()) Fail("libsdformat:" + faults);
}

void LoadStrict(const fs::path &package, const fs::path &file, sdf::Root &root) {
  Require(root.Load(file.string(), Strict(package)));
}

// The first start pose, in a world that only includes the model.
ignition::math::Pose3d FirstSpawn(const std::string &model, const fs::path &package) {
  const auto text = "<sdf version='1.9'><world name='other'><include><uri>model://" + model +
                    "</uri></include><frame name='start'><pose relative_to='" + model +
                    "::spawn_0'>0 0 0 0 0 0</pose></frame></world></sdf>";
  sdf::Root root;
  Require(root.LoadSdfString(text, Strict(package)));
  ignition::math::Pose3d pose;
  Require(root.WorldByIndex(0)->FrameByName("start")->SemanticPose().Resolve(pose));
  return pose;
}

// Lamps in the links of what does not move; none anywhere else, where those who include the model would miss them.
std::size_t CountLamps(const sdf::World &world) {
  if (world.LightCount() != 0) Fail("a lamp is in the world and not in the model");
  std::size_t lamps = 0;
  for (uint64_t m = 0; m < world.ModelCount(); ++m)
    for (uint64_t l = 0; l < world.ModelByIndex(m)->LinkCount(); ++l)
      lamps += world.ModelByIndex(m)->LinkByIndex(l)->LightCount();
  return lamps;
}

const common::Mesh &OpenMesh(const sdf::Geometry &geometry, const fs::path &package) {
  if (geometry.Type() != sdf::GeometryType::MESH) Fail("a shape is not a mesh");
  const auto path = Resolve(geometry.MeshShape()->Uri(), package);
  const auto *mesh = fs::is_regular_file(path) ? common::MeshManager::Instance()->Load(path.string()) : nullptr;
  if (!mesh || mesh->IndexCount() == 0) Fail("cannot load mesh " + path.string());
  return *mesh;
}

void OpenImage(const std::string &uri, const fs::path &package) {
  const auto path = Resolve(uri, package);
  common::Image image;
  if (!fs::is_regular_file(path) || image.Load(path.string()) != 0 || !image.Valid())
    Fail("cannot load image " + path.string());
}

void OpenVisual(const sdf::Visual &visual, const fs::path &package) {
  const auto &mesh = OpenMesh(*visual.Geom(), package);
  if (mesh.TexCoordCount() == 0 || mesh.NormalCount() == 0) Fail("no texture coordinates or normals: " + visual.Name());
  const auto *pbr = visual.Material() ? visual.Material()->PbrMaterial() : nullptr;
  const auto *metal = pbr ? pbr->Workflow(sdf::PbrWorkflowType::METAL) : nullptr;
  if (!metal) Fail("no PBR material: " + visual.Name());
  for (const auto &uri : {metal->AlbedoMap(), metal->NormalMap(), metal->RoughnessMap()}) OpenImage(uri, package);
}

void AppendTriangles(const common::Mesh &mesh, std::vector<Triangle> &triangles) {
  for (unsigned int i = 0; i < mesh.SubMeshCount(); ++i) {
    const auto part = mesh.SubMeshByIndex(i).lock();
    // DART leaves such a mesh out, and crashes if nothing is left.
    if (part->NormalCount() != part->VertexCount()) Fail("a collision mesh has no normals: " + part->Name());
    for (unsigned int k = 0; k + 2 < part->IndexCount(); k += 3)
      triangles.push_back({part->Vertex(part->Index(k)), part->Vertex(part->Index(k + 1)),
                           part->Vertex(part->Index(k + 2))});
  }
}

// Ericson, Real-Time Collision Detection (2005), 5.1.5.
Vector3d NearestOnTriangle(const Vector3d &p, const Triangle &t) {
  const auto &[a, b, c] = t;
  const Vector3d ab = b - a, ac = c - a;
  const double d1 = ab.Dot(p - a), d2 = ac.Dot(p - a);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = ab.Dot(p - b), d4 = ac.Dot(p - b);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const double d5 = ab.Dot(p - c), d6 = ac.Dot(p - c);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  return a + ab * (vb / (va + vb + vc)) + ac * (vc / (va + vb + vc));
}

double Distance(const Vector3d &point, const std::vector<Triangle> &triangles) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto &triangle : triangles) nearest = std::min(nearest, point.Distance(NearestOnTriangle(point, triangle)));
  return nearest;
}

sdf::Root Ball(const Vector3d &centre) {
  std::ostringstream text;
  text << "<sdf version='1.9'><model name='ball'><pose>" << centre << " 0 0 0</pose><link name='ball'><inertial>"
       << "<mass>1</mass><inertia><ixx>" << kInertia << "</ixx><iyy>" << kInertia << "</iyy><izz>" << kInertia
       << "</izz></inertia></inertial>"
       << "<collision name='ball'><geometry><sphere><radius>" << kBallRadiusM
       << "</radius></sphere></geometry></collision></link></model></sdf>";
  sdf::Root root;
  if (!root.LoadSdfString(text.str()).empty()) Fail("the ball of this check is wrong");
  return root;
}

auto Engine(ignition::plugin::Loader &loader) {
  const auto library = fs::path(IGNITION_PHYSICS_ENGINE_INSTALL_DIR) / "libignition-physics5-dartsim-plugin.so.5";
  loader.LoadLib(library.string());
  const auto names = physics::FindFeatures3d<Features>::From(loader);
  if (names.empty()) Fail("no engine with the features of Gazebo in " + library.string());
  return physics::RequestEngine3d<Features>::From(loader.Instantiate(*names.begin()));
}

using LinkPtr = physics::Link3dPtr<Features>;

struct Body {
  LinkPtr link;
  Vector3d start;
  double width_m;
};

struct Contents {
  std::size_t visuals = 0;
  // Of what does not move.
  std::vector<Triangle> triangles;
  std::vector<Body> bodies;
};

Vector3d Place(const LinkPtr &link) {
  return ignition::math::eigen3::convert(Eigen::Vector3d(link->FrameDataRelativeToWorld().pose.translation()));
}

// Opens what a link shows and attaches its collision meshes, as gz-sim does for an engine that builds none itself.
void OpenLink(const sdf::Link &link_sdf, const LinkPtr &link, const fs::path &package, bool is_static,
              Contents &contents) {
  for (uint64_t v = 0; v < link_sdf.VisualCount(); ++v, ++contents.visuals)
    OpenVisual(*link_sdf.VisualByIndex(v), package);
  for (uint64_t c = 0; c < link_sdf.CollisionCount(); ++c) {
    const auto &collision = *link_sdf.CollisionByIndex(c);
    const auto &mesh = OpenMesh(*collision.Geom(), package);
    std::vector<Triangle> of_body;
    AppendTriangles(mesh, is_static ? contents.triangles : of_body);
    const auto scale = collision.Geom()->MeshShape()->Scale();
    link->AttachMeshShape(collision.Name(), mesh, ignition::math::eigen3::convert(collision.RawPose()),
                          ignition::math::eigen3::convert(scale));
    const double width_m = ((mesh.Max() - mesh.Min()) * scale).Max();
    if (!is_static) contents.bodies.push_back({link, Place(link), width_m});
  }
}

Contents OpenWorld(const sdf::World &world_sdf, const physics::World3dPtr<Features> &world, const fs::path &package) {
  Contents contents;
  for (uint64_t m = 0; m < world_sdf.ModelCount(); ++m) {
    const auto &model_sdf = *world_sdf.ModelByIndex(m);
    const auto model = world->GetModel(model_sdf.Name());
    for (uint64_t l = 0; l < model_sdf.LinkCount(); ++l) {
      const auto &link_sdf = *model_sdf.LinkByIndex(l);
      OpenLink(link_sdf, model->GetLink(link_sdf.Name()), package, model_sdf.Static(), contents);
    }
  }
  if (contents.visuals == 0 || contents.triangles.empty()) Fail("the world has no visual or no collision");
  return contents;
}

std::vector<Json::Value> MovableThings(const fs::path &package) {
  std::vector<Json::Value> movable;
  std::ifstream file(package / "instances.json");
  if (!file) return movable;
  Json::Value list;
  file >> list;
  for (const auto &thing : list["things"])
    if (thing["movable"].asBool()) movable.push_back(thing);
  return movable;
}

void CheckBody(const sdf::Model &model, const Json::Value &thing) {
  const auto &place = thing["position"];
  const Vector3d listed(place[0].asDouble(), place[1].asDouble(), place[2].asDouble());
  const double off_m = model.RawPose().Pos().Distance(listed);
  if (!(off_m < kPlaceM)) Fail(model.Name() + " is " + std::to_string(off_m) + " m from its place");
  const auto &turn = thing["orientation_wxyz"];
  const ignition::math::Quaterniond pose(turn[0].asDouble(), turn[1].asDouble(), turn[2].asDouble(), turn[3].asDouble());
  if (!model.RawPose().Rot().Equal(pose, kPlaceM) && !model.RawPose().Rot().Equal(-pose, kPlaceM))
    Fail(model.Name() + " is turned otherwise than listed");
  const auto &mass = model.LinkByIndex(0)->Inertial().MassMatrix();
  const double kg = thing["mass_kg"].asDouble();
  if (!(std::abs(mass.Mass() - kg) < kMassShare * kg)) Fail(model.Name() + " has another mass than listed");
  if (!mass.IsValid(0)) Fail(model.Name() + " has an inertia that no body has");
}

// Counts the models that move.
std::size_t CheckBodies(const sdf::World &world, const fs::path &package) {
  const auto movable = MovableThings(package);
  std::size_t bodies = 0;
  for (uint64_t m = 0; m < world.ModelCount(); ++m) bodies += !world.ModelByIndex(m)->Static();
  if (bodies != movable.size())
    Fail(std::to_string(bodies) + " models move, " + std::to_string(movable.size()) + " things are movable");
  for (const auto &thing : movable) {
    const auto name = thing["class"].asString() + "_" + thing["id"].asString();
    const auto *model = world.ModelByName(name);
    if (!model || model->Static()) Fail("no model that moves is called " + name);
    CheckBody(*model, thing);
  }
  return bodies;
}

struct Rest {
  Vector3d centre;
  double speed_m_s;
};

Rest Drop(const physics::World3dPtr<Features> &world, const Vector3d &from) {
  const auto ball_sdf = Ball(from);
  const auto ball = world->ConstructModel(*ball_sdf.Model())->GetLink(0);
  physics::ForwardStep::Output output;
  physics::ForwardStep::State state;
  physics::ForwardStep::Input input;
  input.Get<std::chrono::steady_clock::duration>() = kStep;
  for (int i = 0; i < kSteps; ++i) world->Step(output, state, input);
  const auto frame = ball->FrameDataRelativeToWorld();
  return {ignition::math::eigen3::convert(Eigen::Vector3d(frame.pose.translation())), frame.linearVelocity.norm()};
}

using JointPtr = physics::Joint3dPtr<Features>;

// The rover of a package, driven as DiffDrive does.
class Rover {
 public:
  Rover(const sdf::Model &model, const ignition::math::Pose3d &pose, const physics::World3dPtr<Features> &world)
      : world_(world) {
    const auto diff = Plugin(model, "gz::sim::systems::DiffDrive");
    radius_m_ = diff->Get<double>("wheel_radius");
    track_m_ = diff->Get<double>("wheel_separation");
    // A pose that is only set is lost, unlike one that is read.
    std::ostringstream text;
    text << "<sdf version='1.9'>" << model.Element()->ToString("") << "</sdf>";
    std::string placed = text.str();
    std::ostringstream place;
    place << "><pose>" << pose * ignition::math::Pose3d(0, 0, kLiftM, 0, 0, 0) << "</pose>";
    placed.replace(placed.find('>', placed.find("<model")), 1, place.str());
    sdf::Root root;
    sdf::ParserConfig config;
    config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::LOG);
    if (!root.LoadSdfString(placed, config).empty()) Fail("the rover cannot be placed");
    const auto body = world->ConstructModel(*root.Model());
    base_ = body->GetLink("base_link");
    for (const auto &[side, joints] : {std::pair{"left_joint", &left_}, {"right_joint", &right_}})
      for (auto e = diff->FindElement(side); e; e = e->GetNextElement(side)) {
        const auto joint = body->GetJoint(e->Get<std::string>());
        if (!joint) Fail("no joint of the rover is called " + e->Get<std::string>());
        joints->push_back(joint);
      }
    Drive(0, 0, 1);
  }

  // Speed of the body in m/s, its turn in rad/s, for some seconds.
  void Drive(double speed, double turn, double seconds) {
    physics::ForwardStep::Output output;
    physics::ForwardStep::State state;
    physics::ForwardStep::Input input;
    input.Get<std::chrono::steady_clock::duration>() = kRoverStep;
    const auto steps = static_cast<int>(seconds * 1e3 / kRoverStep.count());
    for (int i = 0; i < steps; ++i) {
      // The command holds for one step.
      for (auto &joint : left_) joint->SetVelocityCommand(0, (speed - turn * track_m_ / 2) / radius_m_);
      for (auto &joint : right_) joint->SetVelocityCommand(0, (speed + turn * track_m_ / 2) / radius_m_);
      world_->Step(output, state, input);
    }
  }

  ignition::math::Pose3d Pose() const { return ignition::math::eigen3::convert(base_->FrameDataRelativeToWorld().pose); }

 private:
  static sdf::ElementPtr Plugin(const sdf::Model &model, const std::string &name) {
    for (auto e = model.Element()->FindElement("plugin"); e; e = e->GetNextElement("plugin"))
      if (e->Get<std::string>("name") == name) return e;
    Fail("the rover has no " + name);
  }

  physics::World3dPtr<Features> world_;
  LinkPtr base_;
  std::vector<JointPtr> left_, right_;
  double radius_m_ = 0, track_m_ = 0;
};

double UpZ(const ignition::math::Pose3d &pose) { return pose.Rot().RotateVector(Vector3d::UnitZ).Z(); }

// Two seconds straight ahead and two back.
std::string DriveInCave(const sdf::Model &model, const ignition::math::Pose3d &spawn,
                        const physics::World3dPtr<Features> &world) {
  Rover rover(model, spawn, world);
  const auto start = rover.Pose();
  rover.Drive(kSpeedMPerS, 0, kDriveS);
  const auto there = rover.Pose();
  const double ahead_m = start.Rot().RotateVectorReverse(there.Pos() - start.Pos()).X();
  rover.Drive(-kSpeedMPerS, 0, kDriveS);
  const auto back = rover.Pose();
  std::ostringstream told;
  told << "the rover drove " << ahead_m << " m ahead and ended " << back.Pos().Distance(start.Pos()) << " m from its start";
  if (!(std::abs(ahead_m / (kSpeedMPerS * kDriveS) - 1) < kDriveShare)) Fail(told.str());
  if (!(back.Pos().Distance(start.Pos()) < kDriveShare * kSpeedMPerS * kDriveS)) Fail(told.str());
  for (const auto &pose : {start, there, back})
    if (!(UpZ(pose) > kStandsUpright)) Fail("the rover does not stand upright: " + told.str());
  return told.str();
}

// A turn on the spot, on level ground.
std::string TurnOnGround(const sdf::Model &model, const physics::Engine3dPtr<Features> &engine) {
  sdf::Root root;
  const auto *text =
      "<sdf version='1.9'><world name='ground'><model name='ground'><static>true</static><link name='ground'>"
      "<collision name='ground'><pose>0 0 -0.5 0 0 0</pose><geometry><box><size>20 20 1</size></box></geometry>"
      "<surface><friction><ode><mu>0.8</mu><mu2>0.8</mu2></ode></friction></surface></collision>"
      "</link></model></world></sdf>";
  if (!root.LoadSdfString(text).empty()) Fail("the ground of this check is wrong");
  Rover rover(model, {}, engine->ConstructWorld(*root.WorldByIndex(0)));
  const double before = rover.Pose().Yaw();
  rover.Drive(0, kTurnRadPerS, kDriveS);
  const double turned = ignition::math::Angle(rover.Pose().Yaw() - before).Normalized().Radian();
  std::ostringstream told;
  told << "turned " << turned << " rad where " << kTurnRadPerS * kDriveS << " were wanted";
  if (!(std::abs(turned / (kTurnRadPerS * kDriveS) - 1) < kTurnShare)) Fail("the rover " + told.str());
  return told.str();
}

// What the rover did, if there is one.
std::string DriveRover(const fs::path &package, const sdf::World &world_sdf, const ignition::math::Pose3d &spawn,
                       const physics::Engine3dPtr<Features> &engine) {
  const auto file = package / "models" / (world_sdf.Name() + "_rover") / "model.sdf";
  if (!fs::exists(file)) return "";
  sdf::Root root;
  LoadStrict(package, file, root);
  if (!root.Model()) Fail("libsdformat: no rover");
  // Another one: there is a ball in the first.
  const auto world = engine->ConstructWorld(world_sdf);
  OpenWorld(world_sdf, world, package);
  const auto driven = DriveInCave(*root.Model(), spawn, world);
  return ", " + driven + ", " + TurnOnGround(*root.Model(), engine);
}

// How many of the bodies have stayed where they were.
std::size_t CountCalm(const std::vector<Body> &bodies) {
  std::size_t calm = 0;
  for (const auto &[link, start, width_m] : bodies)
    calm += Place(link).Distance(start) < kSettledM + kMovedShare * width_m;
  return calm;
}

int main(int argc, char **argv) try {
  if (argc != 2) Fail("usage: open_package PACKAGE_DIR");
  // The engine reports that it leaves meshes to its caller; everything that matters is checked here.
  common::Console::SetVerbosity(0);
  const fs::path package = fs::absolute(argv[1]);
  sdf::Root root;
  LoadStrict(package, WorldFile(package), root);
  if (root.WorldCount() != 1) Fail("libsdformat: no world");
  const auto &world_sdf = *root.WorldByIndex(0);
  const auto start = FirstSpawn(world_sdf.Name(), package);
  const Vector3d spawn = start.Pos();
  const auto lamps = CountLamps(world_sdf);
  const auto bodies = CheckBodies(world_sdf, package);

  ignition::plugin::Loader loader;
  const auto engine = Engine(loader);
  const auto world = engine->ConstructWorld(world_sdf);
  const auto contents = OpenWorld(world_sdf, world, package);
  const auto [centre, speed_m_s] = Drop(world, spawn + Vector3d(0, 0, kDropM));
  const double gap = Distance(centre, contents.triangles) - kBallRadiusM;

  std::ostringstream where;
  where << "the ball ended at " << centre << ", " << gap << " m from the triangles, at " << speed_m_s << " m/s";
  if (!(std::abs(gap) < kToleranceM)) Fail(where.str());
  if (!(speed_m_s < kRestMPerS)) Fail("it does not rest: " + where.str());
  if (!(centre.Distance(spawn) < kAwayM)) Fail("it did not stay: " + where.str());
  const auto calm = CountCalm(contents.bodies);
  const std::string still = std::to_string(calm) + " of " + std::to_string(bodies) + " movable things stay";
  if (calm < kCalmShare * contents.bodies.size()) Fail("only " + still + " where they are");
  const auto driven = DriveRover(package, world_sdf, start, engine);
  std::cout << "gazebo libraries: " << contents.visuals << " visuals, " << lamps << " lamps, " << contents.triangles.size()
            << " collision triangles, " << still << ", ball_z_m " << centre.Z() << " gap_m " << gap << driven << "\n";
  return 0;
} catch (const std::exception &error) {
  std::cerr << "error: " << error.what() << "\n";
  return 1;
}
