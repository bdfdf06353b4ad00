#pragma once

#include <functional>

#include <zwang/core/files/hdf5.h>
#include <zwang/core/files/problem_file.h>

// The layouts of problem files (docs/formats.md). Each reader fills problem (but its name), notes and origin; what all
// layouts share is done once, in problem_file.cpp.
namespace zwang {

using Sparse = Eigen::SparseMatrix<double>;

// zwang's own layout: the group "zwang" of a problem.
Instance read_own(const hdf5::Group& group, std::optional<Law> law);
void write_own(hdf5::Group& group, const Instance& instance);

// FCLIB's groups "fclib_global" or "fclib_global_rolling", and "fclib_local". Without tangent rows where the law wants
// none.
Instance read_fclib_global(const hdf5::Group& group, std::optional<Law> law, bool rolling);
Instance read_fclib_local(const hdf5::Group& group, std::optional<Law> law);

// Siconos' text files of local frictional problems: dimension, contacts, W (dense or in sparse blocks), q, mu.
Instance read_siconos(const std::filesystem::path& file, std::optional<Law> law);

// u = W r + V lambda + q, V'r + R lambda + s = 0, [N, T...] a contact; V, R and s may be empty, and mu is where nothing
// is known of friction. `fail` throws: the place and what is wrong there.
struct LocalForm {
  Index dim = 3;
  Matrix W = {}, V = {}, R = {};
  Vector q = {}, mu = {}, s = {};
};
using Fail = std::function<void(const std::string& place, const std::string& what)>;
Instance from_local_form(LocalForm form, std::optional<Law> law, const Fail& fail);

// What the p of a sparse matrix's p, i, x counts.
enum class Storage { triplets, columns, rows };

// A matrix of rows x cols from the first `count` entries; duplicates sum. Throws BadFile where an index is out of range
// or an entry is not finite.
Sparse read_sparse(const hdf5::Group& group, Index rows, Index cols, Storage storage, std::size_t count);

// Throws BadFile where an entry is not finite.
Vector read_vector(const hdf5::Group& group, const std::string& name, std::size_t size);

// M with both triangles: one that is empty is mirrored, never averaged; rounding is settled by the lower one; a note
// says so. Throws BadFile where M is not symmetric.
void complete_symmetric(const hdf5::Group& group, const std::string& name, Sparse& M, std::vector<std::string>& notes);

}  // namespace zwang
