#include <algorithm>
#include <cmath>
#include <map>
#include <ranges>

#include <zwang/collision/load.h>
#include <zwang/core/problem/wording.h>
#include <zwang/experiments/god_hand/scenes/scene_objects.h>

namespace zwang::god {
namespace {

namespace fs = std::filesystem;

// A file of this name anywhere below the folder, also packed (.gz).
fs::path find_part(const fs::path& folder, const std::string& name) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (at->path().filename() == name || at->path().filename() == name + ".gz") found.push_back(at->path());
  if (error) throw BadFile(folder.string() + ": " + error.message());
  if (found.empty()) throw BadFile(folder.string() + ": no " + name + " in it, which this scene is made of");
  return *std::min_element(found.begin(), found.end());
}

TreePointer load(const fs::path& file, double unit) {
  return std::make_shared<const collision::Tree>(
      collision::load_tree(file, {.unit = unit, .cache = collision::tree_cache()}).tree);
}

constexpr std::array differential{"ring",          "pinion", "spider",     "side",      "carrier",
                                  "carrier_cover", "arm",    "rightshaft", "leftshaft", "motor_cover"};

std::string differential_file(const std::string& part) { return "diff_" + part + ".stl"; }

// All ten files as one part: they share one frame.
TreePointer whole_differential(const fs::path& folder) {
  collision::Mesh all;
  for (const char* part : differential) {
    const TreePointer tree = load(find_part(folder, differential_file(part)), 1e-3);
    for (const collision::Triangle& t : tree->triangles()) {
      const auto first = static_cast<std::uint32_t>(all.vertices.size());
      all.vertices.insert(all.vertices.end(), t.corner.begin(), t.corner.end());
      all.triangles.push_back({first, first + 1, first + 2});
    }
  }
  return tree_of(all);
}

// In rows, about as wide as deep, tops at z = 0.
std::vector<Object> in_rows(const std::vector<NamedTree>& parts) {
  double area = 0;
  for (const auto& [name, tree] : parts) area += tree->box().sizes().head<2>().prod();
  return laid_out(parts, 1.1 * std::sqrt(area));
}

// The same, standing about a point.
void stand(Surroundings& s, const std::vector<NamedTree>& parts, const Vec3& at) {
  std::vector<Object> group = in_rows(parts);
  Eigen::AlignedBox3d box;
  for (const Object& object : group)
    box.extend({object.pose * object.mesh->box().min(), object.pose * object.mesh->box().max()});
  for (Object& object : group) {
    object.pose.position += at - box.center();
    object.pose.position.z() = at.z() - object.mesh->box().min().z();
    s.objects.push_back(std::move(object));
  }
}

}  // namespace

// Five parts of a differential gear on a table.
Surroundings real_simple_scene(const fs::path& folder) {
  Surroundings s{.name = "simple"};
  std::vector<NamedTree> parts;
  for (std::size_t k = 0; k < 5; ++k)
    parts.emplace_back(differential[k], load(find_part(folder, differential_file(differential[k])), 1e-3));
  stand(s, parts, Vec3::Zero());
  s.objects.push_back(table("table", {0.6, 0.5, 0.03}, Vec3::Zero(), 5000));
  add_box_and_can(s, {0.11, 0.07, 0}, {0.1, -0.07, 0});
  s.focus = busiest_place(s);
  return s;
}

// Two round plates, the decks; on one of them whole differentials, on the other drives, gears and bolts.
Surroundings real_engine_scene(const fs::path& folder) {
  Surroundings s{.name = "engine"};
  std::vector<NamedTree> parts;
  const auto add = [&](int count, const std::string& name, const TreePointer& tree) {
    for (int k = 1; k <= count; ++k) parts.emplace_back(name + " " + std::to_string(k), tree);
  };
  add(3, "differential", whole_differential(folder));
  stand(s, parts, {-0.155, 0, 0});
  parts.clear();
  add(3, "cycloidal drive", load(find_part(folder, "cycloidal.ply"), 0.0254));
  add(3, "gear", load(find_part(folder, "factory_gear_medium_space_5e-4.obj"), 1));
  add(4, "bolt M20", load(find_part(folder, "factory_bolt_m20_loose.obj"), 1));
  add(3, "bolt M8", load(find_part(folder, "factory_bolt_m8_loose.obj"), 1));
  add(2, "bolt M16", load(find_part(folder, "factory_bolt_m16_loose.obj"), 1));
  stand(s, parts, {0.155, 0, 0});
  const TreePointer deck = load(find_part(folder, "counter.unitsmm.STL"), 1e-3);
  for (const double x : {-0.155, 0.155})
    s.objects.push_back(
        fixed("deck", deck, Vec3(x, 0, -deck->box().max().z()) - deck->box().center().cwiseProduct(Vec3(1, 1, 0))));
  const Vec3 tray(0, -0.16, 0);
  s.objects.push_back(table("tray", {0.16, 0.09, 0.012}, tray, 10000));
  add_small_parts(s, tray);
  s.focus = busiest_place(s);
  return s;
}

Surroundings files_scene(const std::string& files) {
  Surroundings s{.name = files};
  std::vector<NamedTree> parts;
  std::map<std::string, TreePointer> known;
  for (const auto part : std::views::split(files, ',')) {
    const std::string item(part.begin(), part.end());
    if (item.empty()) throw BadFile("'" + files + "': a file name is missing");
    const auto [file, unit] = collision::parse_mesh_name(item);
    TreePointer& tree = known[item];
    if (!tree) tree = load(file, unit);
    // Without a unit metres may be meant, but not where a part of 3 mm or more is in a file of millimetres.
    const bool given = file != item;
    const double width = tree->box().sizes().maxCoeff();
    if (width > (given ? 50 : 3) || width < 1e-3)
      throw BadFile(file.string() + ": " + printed("%.3g", width) + " m wide; " +
                    (given ? "in its unit 1 mm to 50 m expected"
                           : "give its unit, such as " + file.filename().string() + "@mm (or @m, if it is)"));
    parts.emplace_back(file.filename().string(), tree);
  }
  s.objects = in_rows(parts);
  s.focus = busiest_place(s);
  return s;
}

}  // namespace zwang::god
