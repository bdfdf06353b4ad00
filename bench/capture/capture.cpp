#include <zwang/bench/capture/capture.h>

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <stdexcept>

#include <zwang/bench/capture/model_file.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/mix_bits.h>
#include <zwang/core/problem/row_writer.h>

namespace zwang {
namespace {

class Model {
 public:
  // Frictionless in MuJoCo's own run, and as exact as its Newton solver goes.
  Model(const std::filesystem::path& file, bool friction)
      : family_(file.stem().string()), friction_(friction), model_(load_model(file)) {
    mjModel& m = *model_;
    if (m.nv == 0) throw BadFile(file.string() + ": nothing in this model moves; expected a body with a joint");
    condim_.assign(m.geom_condim, m.geom_condim + m.ngeom);
    pair_dim_.assign(m.pair_dim, m.pair_dim + m.npair);
    std::fill_n(m.geom_condim, m.ngeom, 1);
    std::fill_n(m.pair_dim, m.npair, 1);
    std::fill_n(m.dof_frictionloss, m.nv, 0);
    std::fill_n(m.tendon_frictionloss, m.ntendon, 0);
    m.opt.solver = mjSOL_NEWTON;
    m.opt.iterations = 1000;
    m.opt.tolerance = 1e-15;
    m.opt.noslip_iterations = 0;
    m.opt.jacobian = mjJAC_SPARSE;
    data_.reset(mj_makeData(&m));
    if (!data_) throw BadFile(file.string() + ": MuJoCo has not enough memory for this model");
  }
  void forward() { mj_forward(model_.get(), data_.get()); }
  void step() {
    mj_step(model_.get(), data_.get());
    for (const int warning : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC, mjWARN_CONTACTFULL, mjWARN_CNSTRFULL})
      if (data_->warning[warning].number > 0)
        throw std::runtime_error(std::string("MuJoCo stopped: ") +
                                 mju_warningText(warning, data_->warning[warning].lastinfo));
  }
  Instance problem() const {
    const mjModel& m = *model_;
    const mjData& d = *data_;
    Instance out;
    Problem& p = out.problem;
    out.family = family_;
    const auto n = static_cast<Index>(m.nv);
    std::vector<Eigen::Triplet<double>> mass;
    for (int i = 0; i < m.nv; ++i)
      for (int j = i, at = m.dof_Madr[i]; j >= 0; j = m.dof_parentid[j], ++at) {
        mass.emplace_back(i, j, d.qM[at]);
        if (i != j) mass.emplace_back(j, i, d.qM[at]);
      }
    p.M = sparse_of<SparseMatrix>(n, n, mass);
    p.z_u = Eigen::Map<const Vector>(d.qacc_smooth, n);
    add_rows(out);
    if (!p.has_tangents()) out.recorded.push_back({.by = "mujoco", .z = Eigen::Map<const Vector>(d.qacc, n)});
    return out;
  }

 private:
  void add_rows(Instance& out) const {
    const mjModel& m = *model_;
    const mjData& d = *data_;
    Problem& p = out.problem;
    RowWriter rows;
    std::map<std::array<int, 2>, int> seen;     // contacts of one pair of geoms, in MuJoCo's order
    std::map<std::array<int, 2>, int> rows_of;  // equality 0, joint limit 1, tendon limit 2; by its number
    for (int i = 0; i < d.nefc; ++i) {
      const int id = d.efc_id[i];
      RowKey key;
      const mjContact* slides = nullptr;
      if (d.efc_type[i] == mjCNSTR_EQUALITY) {
        const int row = rows_of[{0, id}]++;
        out.origin.push_back({.type = "equality", .label = name(mjOBJ_EQUALITY, id), .row = row});
        key = {mix_bits(1), static_cast<std::uint32_t>(64 * id + row)};
      } else if (d.efc_type[i] == mjCNSTR_LIMIT_JOINT || d.efc_type[i] == mjCNSTR_LIMIT_TENDON) {
        const bool joint = d.efc_type[i] == mjCNSTR_LIMIT_JOINT;
        // Both sides of one limit may be near.
        const int side = rows_of[{joint ? 1 : 2, id}]++;
        out.origin.push_back({.type = joint ? "joint limit" : "tendon limit",
                              .label = name(joint ? mjOBJ_JOINT : mjOBJ_TENDON, id) + (side ? ", other side" : "")});
        key = {mix_bits(joint ? 2 : 3), static_cast<std::uint32_t>(2 * id + side)};
      } else {
        const mjContact& contact = d.contact[id];
        key = name_contact(out, contact, seen[{contact.geom1, contact.geom2}]++);
        if (friction_ && dimension(contact) > 1 && contact.friction[0] > 0) slides = &contact;
      }
      rows.add(d.efc_type[i] == mjCNSTR_EQUALITY ? RowKind::equality : RowKind::inequality, key, d.efc_aref[i],
               slides ? slides->friction[0] : 0);
      for (int e = d.efc_J_rowadr[i]; e < d.efc_J_rowadr[i] + d.efc_J_rownnz[i]; ++e)
        if (d.efc_J[e] != 0) rows.entry(d.efc_J_colind[e], d.efc_J[e]);
      if (!slides) continue;
      const Eigen::Matrix<double, 2, Eigen::Dynamic> T = tangents(*slides);
      for (int slip = 0; slip < 2; ++slip) {
        rows.add(RowKind::tangent, {key.constraint, key.row + static_cast<std::uint32_t>(slip) + 1},
                 -T.row(slip).dot(Eigen::Map<const Vector>(d.qvel, m.nv)) / m.opt.timestep);
        rows.entries(T.row(slip).transpose());
        out.origin.push_back(out.origin.back());
        out.origin.back().row = slip + 1;
      }
    }
    rows.write(p);
    if (p.has_tangents()) p.law = stored_law;
  }
  // Four keys a contact where there may be tangents, or edges of a pyramid.
  RowKey name_contact(Instance& out, const mjContact& c, int which) const {
    const std::uint64_t pair = (static_cast<std::uint64_t>(c.geom1) << 32) | static_cast<std::uint32_t>(c.geom2);
    out.origin.push_back({.type = "contact",
                          .label = name(mjOBJ_GEOM, c.geom1) + " on " + name(mjOBJ_GEOM, c.geom2) +
                                   (which ? ", " + std::to_string(which + 1) : ""),
                          .unit = "m/s^2"});
    return {mix_bits(pair + 4), static_cast<std::uint32_t>(friction_ ? 4 * which : which)};
  }
  // The point's velocity on the second body less that on the first, along the two tangents of the frame.
  Eigen::Matrix<double, 2, Eigen::Dynamic> tangents(const mjContact& c) const {
    using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
    const mjModel& m = *model_;
    Rows first(3, m.nv), second(3, m.nv);
    mj_jac(&m, data_.get(), first.data(), nullptr, c.pos, m.geom_bodyid[c.geom1]);
    mj_jac(&m, data_.get(), second.data(), nullptr, c.pos, m.geom_bodyid[c.geom2]);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> frame(c.frame);
    return frame.bottomRows<2>() * (second - first);
  }
  std::string name(int kind, int id) const {
    const char* given = mj_id2name(model_.get(), kind, id);
    return given ? given : std::to_string(id);
  }
  // Of contact rows as the model asks for them: 1 is frictionless.
  int dimension(const mjContact& c) const {
    if (c.exclude == 0 && c.geom1 >= 0 && c.geom2 >= 0) {
      for (int pair = 0; pair < model_->npair; ++pair)
        if (std::minmax(model_->pair_geom1[pair], model_->pair_geom2[pair]) == std::minmax(c.geom1, c.geom2))
          return pair_dim_[static_cast<std::size_t>(pair)];
      const int first = model_->geom_priority[c.geom1], second = model_->geom_priority[c.geom2];
      const int one = condim_[static_cast<std::size_t>(c.geom1)], two = condim_[static_cast<std::size_t>(c.geom2)];
      return first == second ? std::max(one, two) : first > second ? one : two;
    }
    return 1;
  }

  std::string family_;
  bool friction_;
  std::unique_ptr<mjModel, DeleteModel> model_;
  std::unique_ptr<mjData, DeleteModel> data_;
  std::vector<int> condim_, pair_dim_;  // as the model has them
};

}  // namespace

void capture(const CaptureOptions& options, const std::function<void(int step, const Instance&)>& found) {
  Model model(options.model, options.friction);
  for (int step = 0; step < options.steps; ++step) {
    if (step % options.every == 0) {
      model.forward();
      Instance instance = model.problem();
      instance.problem.name = instance.family + " step " + std::to_string(step);
      instance.knob = "step";
      instance.knob_value = step;
      found(step, instance);
    }
    model.step();
  }
}

}  // namespace zwang
