#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <zwang/collision/mesh.h>
#include <zwang/experiments/god_hand/scenes/surroundings.h>

// What scenes are put together from.
namespace zwang::god {

using TreePointer = std::shared_ptr<const collision::Tree>;
TreePointer tree_of(const collision::Mesh& mesh);

// The rotation that takes z to x, to y.
Mat3 z_to_x();
Mat3 z_to_y();

// Meshes beyond those of meshes::, in metres, centred; of about `triangles` triangles, closed.
collision::Mesh cylinder_mesh(double radius, double height, int sides);             // along z, a prism
collision::Mesh capsule_mesh(double length, double radius, std::size_t triangles);  // along z
collision::Mesh casting(const Vec3& widths, int waves, std::size_t triangles);      // a bulging, bumpy box

// A convex piece of a loose object.
struct Solid {
  collision::Shape shape;
  double volume;         // m^3
  Vec3 gyration;         // m^2: inertia about its centre / mass
  collision::Mesh mesh;  // drawn
  Pose<double> at = {};

  Solid placed(const Vec3& position, const Mat3& rotation = Mat3::Identity()) &&;
};
Solid solid_box(const Vec3& widths);
Solid solid_cylinder(double radius, double height, int sides = 16);  // along z
Solid solid_bar(double length, double radius);                       // a capsule along z; length between its ends
Solid solid_ball(double radius);

// A loose object of homogeneous solids, given in axes of their own of which the origin comes to `origin`.
Object loose(const std::string& name, double mass, const std::vector<Solid>& solids, const Vec3& origin,
             const Mat3& rotation = Mat3::Identity());
Object fixed(const std::string& name, TreePointer mesh, const Vec3& position, const Mat3& rotation = Mat3::Identity());
// A fixed plate, its upper side at top.z(): finely cut for hands, one box for the physics engine.
Object table(const std::string& name, const Vec3& widths, const Vec3& top, std::size_t triangles);

// Fixed parts side by side in rows of this width [m], their tops at z = 0.
using NamedTree = std::pair<std::string, TreePointer>;
std::vector<Object> laid_out(const std::vector<NamedTree>& parts, double row);

// Lifts loose objects that overlap something, a few millimetres at most. Throws std::runtime_error, one line, naming
// the pair, where that is not enough.
void lift_clear(Surroundings& surroundings);

// The highest point of any object's mesh over (x, y); z = -infinity where there is none.
Vec3 surface_at(const Surroundings& surroundings, double x, double y);

// Where a hand pressed down would meet the most: within its reach the surfaces of many objects at much the same height.
Vec3 busiest_place(const Surroundings& surroundings);

// The scenes that are large.
Surroundings simple_scene();
Surroundings engine_scene();
Surroundings detailed_scene();

// Loose things of an engine bay: a cap, a relay, and a bolt standing on its head.
void add_small_parts(Surroundings& s, const Vec3& on);
void add_box_and_can(Surroundings& s, const Vec3& box, const Vec3& can);

// Of real parts, found in the folder by their file names. Throw BadFile.
Surroundings real_simple_scene(const std::filesystem::path& parts);
Surroundings real_engine_scene(const std::filesystem::path& parts);

// Files "a.stl,b.obj@mm" side by side, their tops at z = 0. Throws BadFile.
Surroundings files_scene(const std::string& files);

}  // namespace zwang::god
