// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "tools/sim/world/portable_math.h"
#include "tools/sim/world/terrain.h"

// A world to drive in: ground, bodies that stand on it, people who walk through it; hit by rays and
// touched by a vehicle (contact.h). Nothing in it depends on libm or on the order of calls: each
// ray's own key decides whether leaves stop it. Frame: the world's, metres, x and y level, z up; in
// named worlds the vehicle starts at the origin, facing +x (named_worlds.h).

namespace hardpack::world {

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Codes of the RELLIS-3D ontology, as core/segmentation/label_table.h reads them.
enum class Label : uint8_t {
  kVoid = 0,
  kDirt = 1,
  kGrass = 3,
  kTree = 4,
  kPole = 5,
  kVehicle = 8,
  kObject = 9,
  kBuilding = 12,
  kLog = 15,
  kPerson = 17,
  kFence = 18,
  kBush = 19,
  kBarrier = 27,
  kRubble = 34,
};

// What happens to a ray that hits a body.
enum class Matter : uint8_t {
  kSolid,    // it ends at the surface
  kMesh,     // it ends at the surface, or passes through the whole body
  kFoliage,  // it ends somewhere within, or passes through
};

struct Material {
  Label label = Label::kObject;
  Matter matter = Matter::kSolid;
  // kMesh: the share of rays that end; kFoliage: returns per metre of way within, so that
  // exp(-seen * way) pass.
  double seen = 1.0;
};

struct Point2 {
  double x_m = 0.0;
  double y_m = 0.0;
};

enum class Shape : uint8_t { kPrism, kCylinder, kEllipsoid };  // all upright

// One thing in the world. Prisms have their corners in the world.
struct Body {
  Shape shape = Shape::kCylinder;
  double x_m = 0.0;  // middle
  double y_m = 0.0;
  double radius_m = 0.0;  // level; of a prism, that of the circle around it
  double low_m = 0.0;
  double high_m = 0.0;
  Material material;
  uint32_t first_side = 0;
  uint32_t sides = 0;  // of a prism
};

// Of a prism: from its corner to the next one, anticlockwise.
struct Side {
  Point2 corner;
  double normal_x = 0.0;  // outward, length 1
  double normal_y = 0.0;
  double offset_m = 0.0;  // inside: normal . p <= offset
};

// Where a person wants to be at which time, with uniform speed in between. Before the first and
// after the last time the person stands, unless the places repeat.
struct Person {
  struct Place {
    double time_s = 0.0;
    double x_m = 0.0;
    double y_m = 0.0;
  };
  std::vector<Place> places;  // by ascending time; not empty
  bool repeats = false;       // after the last place comes the first
  double radius_m = 0.25;
  double height_m = 1.75;

  Point2 At(double time_s) const;
};

// A straight ditch with a flat bottom as wide as each of its banks.
struct Ditch {
  Point2 from;
  Point2 to;
  double half_width_m = 1.0;
  double depth_m = 1.0;

  // Depth below the ground at that place; 0 beside the ditch.
  double Depth_m(double x_m, double y_m) const;
};

// A round patch of ground that holds less, or more, than what is around it; friction > 0.
struct Patch {
  Point2 middle;
  double radius_m = 0.0;
  double friction = 0.0;
};

struct Ray {
  Vector origin;
  Vector direction;  // length 1
  double max_range_m = 110.0;
  uint64_t key = 0;  // for the random passage through leaves and meshes
};

struct Hit {
  double range_m = -1.0;  // negative: nothing
  Label label = Label::kVoid;
  uint8_t reflectivity = 0;

  bool any() const { return range_m >= 0.0; }
};

class World {
 public:
  World() : World(Bounds{}) {}
  // Empty. Without a terrain: level ground at height 0.
  explicit World(const Bounds& bounds, Terrain terrain = {}, Label ground = Label::kGrass);

  // Heights here are the world's; low_m < high_m. Bodies without a size, with numbers that are not
  // finite, or more than 1000 km away are ignored. heading_rad is the direction of the length.
  void AddBox(Point2 middle, double heading_rad, double length_m, double width_m, double low_m,
              double high_m, const Material& material);
  // The corners of a convex outline, anticlockwise, at least three.
  void AddPrism(std::span<const Point2> corners, double low_m, double high_m,
                const Material& material);
  void AddCylinder(Point2 middle, double radius_m, double low_m, double high_m,
                   const Material& material);
  void AddEllipsoid(const Vector& middle, double radius_m, double half_height_m,
                    const Material& material);
  void AddPerson(const Person& person) {
    people_.push_back(person);
    detours_.push_back({});
  }
  // How far a person is beside their way from now on (walk.h).
  void SetDetour(size_t person, Point2 detour) { detours_[person] = detour; }
  // For contact.h: the terrain has it already.
  void AddDitch(const Ditch& ditch) { ditches_.push_back(ditch); }

  // How much the ground holds: the share of the weight on it that a tyre can push with. 0, as at
  // first: everything, and gravity does nothing to a vehicle (tools/sim/vehicle/body_on_ground.h).
  void SetFriction(double friction) { friction_ = friction; }
  // Where patches overlap the last one counts. Without SetFriction they do not.
  void AddPatch(const Patch& patch) { patches_.push_back(patch); }
  bool has_friction() const { return friction_ > 0.0; }
  double friction() const { return friction_; }
  Label ground_label() const { return ground_label_; }
  double FrictionAt(double x_m, double y_m) const;
  const std::vector<Patch>& patches() const { return patches_; }

  // Where a person is: on their way, or beside it by their detour.
  Point2 PersonAt(size_t person, double time_s) const;
  // The people as bodies at a time, for Cast: many rays share them.
  std::vector<Body> PeopleAt(double time_s) const;

  // The first thing that a ray hits within its range. A ray that begins in a solid body or under
  // the ground hits it at range 0. No hit: a direction that is not finite or not of length 1 (to
  // 1e-3), a range that is not positive, an origin outside the bounds with the ray pointing away.
  Hit Cast(const Ray& ray, std::span<const Body> people) const;
  Hit Cast(const Ray& ray, double time_s) const { return Cast(ray, PeopleAt(time_s)); }

  double GroundHeight_m(double x_m, double y_m) const { return terrain_.Height_m(x_m, y_m); }
  Ground GroundAt(double x_m, double y_m) const { return terrain_.At(x_m, y_m); }

  const Bounds& bounds() const { return bounds_; }
  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<Person>& people() const { return people_; }
  const std::vector<Ditch>& ditches() const { return ditches_; }
  std::span<const Side> SidesOf(const Body& body) const {
    return std::span<const Side>(sides_).subspan(body.first_side, body.sides);
  }

 private:
  static constexpr double kCell_m = 2.0;
  static constexpr int32_t kFarCells = 16;

  struct SquareCell {
    double ground_high_m = 0.0;
    double top_m = 0.0;  // of ground and bodies
    // Cells to the nearest one with a body, along the axis on which they are more; kFarCells: no
    // nearer one.
    int32_t to_body = kFarCells;
    std::vector<uint32_t> bodies;
  };
  struct Way {  // along a ray
    double from_m = 0.0;
    double to_m = 0.0;
  };

  // reach: half of its extent along x and y.
  void AddBody(const Body& body, Point2 reach);
  void TellDistances(int first_column, int last_column, int first_row, int last_row);
  bool IsWithin(const Ray& ray, Way& way) const;
  void Walk(const Ray& ray, Way way, Hit& hit) const;
  void MeetBodies(const Ray& ray, const SquareCell& cell, double low_m, Hit& hit) const;
  void MeetBody(const Ray& ray, const Body& body, uint64_t index, Hit& hit) const;
  void MeetGround(const Ray& ray, const SquareCell& cell, Way way, Hit& hit) const;
  bool Crosses(const Ray& ray, const Body& body, Way& way) const;
  Hit HitAt(double range_m, Label label) const;

  Bounds bounds_;
  Terrain terrain_;
  Label ground_label_;
  int columns_ = 0;
  int rows_ = 0;
  double top_m_ = 0.0;
  double ground_top_m_ = 0.0;
  Bounds furnished_ = {0.0, 0.0, 0.0, 0.0};  // all bodies lie within
  std::vector<SquareCell> cells_;            // [rows x columns]
  std::vector<Body> bodies_;
  std::vector<Side> sides_;
  std::vector<Person> people_;
  std::vector<Point2> detours_;  // of the people
  std::vector<Ditch> ditches_;
  double friction_ = 0.0;
  std::vector<Patch> patches_;
};

}  // namespace hardpack::world
