#include <zwang/bench/packs/pack.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include <zwang/bench/references/reference.h>
#include <zwang/bench/results/record_file.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/suite/plan.h>
#include <zwang/core/files/embedded.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/problem/wording.h>

ZWANG_EMBEDDED(packs_json, ZWANG_PACKS)

namespace zwang {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PackedProblem, file, sha256, name, family, law, n, m, equalities, known, method)

namespace {

using Json = nlohmann::ordered_json;

constexpr int pack_format = 1;

std::string known(const std::optional<Reference>& reference) {
  if (!reference) return "nothing";
  if (!reference->feasible) return "infeasible";
  return reference->unique ? "answer" : "some answer";
}

PackedProblem described(const Instance& instance, std::string file) {
  const Problem& p = instance.problem;
  return {.file = std::move(file),
          .sha256 = problem_sha256(p),
          .name = p.name,
          .family = instance.family,
          .law = std::string(to_string(p.law)),
          .n = p.size(),
          .m = p.rows(),
          .equalities = std::count(p.kind.begin(), p.kind.end(), RowKind::equality),
          .known = known(instance.reference),
          .method = instance.reference ? instance.reference->method : ""};
}

Json to_json(const PackedProblem& p) {
  return {{"file", p.file},   {"sha256", p.sha256}, {"name", p.name}, {"family", p.family},
          {"law", p.law},     {"n", p.n},           {"m", p.m},       {"equalities", p.equalities},
          {"known", p.known}, {"method", p.method}};
}

PackedProblem packed(const nlohmann::json& j) {
  PackedProblem p = j;
  const std::filesystem::path file = p.file;
  if (file.is_absolute() || std::ranges::find(file, "..") != file.end())
    throw std::runtime_error("'" + p.file + "' should be a file within the pack");
  return p;
}

}  // namespace

Pack::Pack(std::filesystem::path directory) : directory_(std::move(directory)) {
  const std::filesystem::path index = directory_ / "pack.json";
  const auto bad = [&](const std::string& why) { return BadFile(index.string() + ": " + one_line(why)); };
  const std::string text = read_stored(index).bytes;
  try {
    const auto all = nlohmann::json::parse(text);
    if (const int version = all.at("zwang_pack").get<int>(); version != pack_format)
      throw std::runtime_error("zwang_pack is " + std::to_string(version) + ", expected " +
                               std::to_string(pack_format));
    std::set<std::string> seen;
    for (const nlohmann::json& problem : all.at("problems")) {
      problems_.push_back(packed(problem));
      if (!seen.insert(problems_.back().sha256).second)
        throw std::runtime_error("the problem " + problems_.back().sha256 + " stands there twice");
    }
  } catch (const std::exception& wrong) {
    throw bad(wrong.what());
  }
  if (problems_.empty()) throw bad("it lists no problem");
}

std::vector<std::filesystem::path> Pack::files() const {
  return mapped(problems_, [&](const PackedProblem& p) { return directory_ / p.file; });
}

const PackedProblem* Pack::find(const std::string& sha256) const {
  const auto found = std::ranges::find(problems_, sha256, &PackedProblem::sha256);
  return found == problems_.end() ? nullptr : &*found;
}

void Pack::check() const {
  for (const PackedProblem& p : problems_) {
    const std::vector<Instance> read = read_problems(directory_ / p.file);
    PackedProblem found = read.size() == 1 ? described(read[0], p.file) : PackedProblem();
    found.known = p.known, found.method = p.method;
    if (found != p)
      throw BadFile((directory_ / p.file).string() + ": not the problem of which pack.json speaks, " + p.name);
  }
}

std::span<const NamedPack> named_packs() {
  static const std::vector<NamedPack> all = [] {
    std::vector<NamedPack> read;
    for (const Json& j : Json::parse(packs_json())) {
      NamedPack& pack = read.emplace_back(NamedPack{j.at("name"), j.at("line"), {}});
      for (const Json& part : j.at("parts"))
        pack.scenes.emplace_back(
            part.contains("suite") ? find_suite(part["suite"]).scenes
                                   : joined(part.at("scenes").get<std::vector<std::string>>(), ","),
            part.contains("law") ? std::optional(parse_law(part["law"].get<std::string>())) : std::nullopt);
    }
    return read;
  }();
  return all;
}

std::vector<Instance> problems_of_pack(const std::vector<std::string>& words, std::uint64_t seed) {
  std::vector<Instance> all;
  const auto named = [&](const std::string& word) { return std::ranges::find(named_packs(), word, &NamedPack::name); };
  for (const std::string& word : words) {
    std::vector<Instance> some;
    if (const auto pack = named(word); pack != named_packs().end()) {
      for (const auto& [scenes, law] : pack->scenes)
        for (Instance& instance : make_scenes(scenes, seed))
          some.push_back(law ? under(*law, std::move(instance)) : std::move(instance));
    } else if (std::error_code too_long; std::filesystem::exists(word, too_long)) {
      some = make_plan({.problems = {word}, .solvers = "dual_active_set"}).instances;
    } else {
      some = make_scenes(word, seed);
    }
    std::ranges::move(some, std::back_inserter(all));
  }
  std::set<std::string> seen;
  std::erase_if(all, [&](const Instance& i) { return !seen.insert(problem_sha256(i.problem)).second; });
  return all;
}

std::size_t write_pack(const std::filesystem::path& directory, std::vector<Instance> problems,
                       const std::string& made_by, const std::filesystem::path& cache, const PackProgress& progress) {
  std::filesystem::create_directories(directory / "problems");
  Json index = {{"zwang_pack", pack_format}, {"made_by", made_by}, {"problems", Json::array()}};
  for (std::size_t k = 0; k < problems.size(); ++k) {
    Instance& instance = problems[k];
    progress(k, instance.problem.name);
    instance.reference = reference_for(instance, cache).reference;
    const std::string file = problem_file(k);
    write_problem(directory / file, instance);
    index["problems"].push_back(to_json(described(instance, file)));
  }
  replace_file(directory / "pack.json", index.dump(1) + "\n");
  return problems.size();
}

}  // namespace zwang
