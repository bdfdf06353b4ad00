#include <zwang/experiments/god_hand/run/run.h>

#include <algorithm>

#include <zwang/bench/collision/audit.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/experiments/god_hand/hand/hand_shapes.h>
#include <zwang/experiments/god_hand/measure/disturbance.h>
#include <zwang/experiments/god_hand/run/frame_store.h>
#include <zwang/experiments/god_hand/run/replay.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/tools/play.h>
#include <zwang/solvers/registry.h>

namespace zwang::god {
namespace {

// Of all objects, the fixed ones too.
std::vector<Pose<double>> object_poses(const Surroundings& surroundings, const Frame& frame) {
  std::vector<Pose<double>> poses;
  auto loose = frame.loose.begin();
  for (const Object& object : surroundings.objects) poses.push_back(object.loose() ? *loose++ : object.pose);
  return poses;
}

}  // namespace

Setup set_up(Record& record) {
  Asked& asked = record.asked;
  asked.options = chosen(asked.options);
  make_solver(asked.options.solver);  // its complaint comes before the work on a large scene
  if (asked.options.mu > 0 && find_solver(asked.options.solver)->laws.empty())
    throw std::invalid_argument(asked.options.solver + " does not read friction: --mu 0, or another solver");
  Setup setup;
  if (asked.god != "hand") setup.tool = make_tool(asked.god);
  record.recorded = names_file(asked.motion);
  std::optional<HandMotion> path;
  if (record.recorded && setup.tool) path = read_path(asked.motion, *setup.tool);
  if (path) asked.share = 0;  // it says itself where it is
  if (record.recorded) setup.motion = path ? std::move(*path) : read_motion(asked.motion);
  setup.surroundings = make_surroundings(asked.scene, asked.parts);
  if (!record.recorded) setup.motion = synthetic_motion(asked.motion, setup.surroundings);
  if (record.recorded && asked.share > 0) record.placement = place(setup.motion, setup.surroundings, asked.share);

  record.title = record.recorded ? std::filesystem::path(asked.motion).stem().string() : asked.motion;
  record.motion = fingerprint(setup.motion);
  record.surroundings = fingerprint(setup.surroundings);
  record.god = setup.tool ? fingerprint(*setup.tool) : 0;
  record.hands = setup.motion.hands.size();
  record.bodies = setup.tool ? setup.tool->objects.shapes.size() : record.hands * hand::bodies;
  record.loose = at(std::ranges::count_if(setup.surroundings.objects, &Object::loose));
  record.held_over = 0;
  for (const Track& track : setup.motion.hands) {
    record.held_over += track.held_over;
    record.misfit_mean = std::max(record.misfit_mean, track.misfit_mean);
    record.misfit_most = std::max(record.misfit_most, track.misfit_most);
  }
  record.notes = setup.motion.notes;
  const long whole = static_cast<long>(setup.motion.duration / asked.options.dt + 1e-6) + 1;
  asked.frames = asked.frames > 0 ? std::min(asked.frames, whole) : whole;
  return setup;
}

long simulate(const std::filesystem::path& directory, const Record& record, const Setup& setup, bool resume,
              const ShowProgress& progress, const std::atomic<bool>& interrupted) {
  Play play(setup.surroundings, setup.motion, record.asked.options, setup.tool ? &*setup.tool : nullptr);
  Simulation& simulation = play.simulation();
  const Checkpoint from = resume ? read_checkpoint(directory) : Checkpoint{};
  if (from.frames > 0) simulation.restore(from.state);
  FrameWriter writer(directory, record.bodies, record.loose, from.frames);
  long k = from.frames;
  for (; k < record.asked.frames && !interrupted; ++k) {
    const Frame& frame = play.step(k);
    writer.write(frame);
    progress(static_cast<double>(k + 1) / static_cast<double>(record.asked.frames),
             grouped(at(k + 1)) + " frames, " + std::to_string(frame.kept) + " contacts");
    if ((k + 1) % checkpoint_every != 0) continue;
    writer.flush();
    write_checkpoint(directory, {k + 1, simulation.checkpoint()});
  }
  writer.flush();
  return k;
}

Finished finish(const std::filesystem::path& directory, const Record& record, const Setup& setup,
                const ShowProgress& progress) {
  std::vector<ShownGod> gods;
  if (setup.tool)
    gods.push_back({setup.tool->name, false, setup.tool->objects.shapes});
  else
    for (const hand::Model& model : models_of(setup.motion)) gods.push_back({"hand", model.left, hand::shapes(model)});
  const auto shapes = mapped(gods, &ShownGod::shapes);
  const std::vector<MetPart> parts = met_parts(setup.surroundings);
  std::vector<Obstacle> obstacles;
  if (record.asked.audit)  // FCL's tree of a million triangles takes seconds
    for (const MetPart& part : parts) obstacles.push_back(part.body);
  Audit audit(shapes, obstacles);
  long first = -1;
  Finished out;
  const auto planned = static_cast<double>(record.asked.frames);
  const FrameReader reader(directory);
  ShownFrames shown(reader.frames());
  Held held;
  double hardest = 0;
  long held_in = -1;
  reader.each([&](const Frame& frame) {
    out.summary.add(frame);
    hardest = std::max(hardest, frame.grip);
    if (frame.grip > 0 && 2 * frame.grip >= hardest) {
      held = held_hardest(frame, setup.surroundings);
      held_in = frame.number;
    }
    shown.add(frame);
    if (!record.asked.audit) return;
    const std::vector<Pose<double>> objects = object_poses(setup.surroundings, frame);
    if (audit.check(frame.god, met_poses(parts, objects)) > 0 && first < 0) first = frame.number;
    progress(static_cast<double>(out.summary.frames()) / planned, "FCL looks at every frame");
  });
  if (record.asked.audit) out.summary.set_audit({audit.checked(), audit.found(), audit.crossed(), first});
  if (held_in >= 0)
    out.summary.set_disturbance(largest_disturbance(held.contacts, held.weight, record.asked.options.mu), held_in);
  replace_file(directory / "summary.json", out.summary.json(record));
  if (out.summary.frames() > 0)
    out.replay = write_replay(directory, record, out.summary, shown.frames(), setup.surroundings, gods);
  return out;
}

}  // namespace zwang::god
