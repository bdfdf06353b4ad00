#pragma once

#include <zwang/core/files/contact_forms.h>
#include <zwang/core/files/hdf5.h>
#include <zwang/core/files/problem_file.h>

// The layouts of problem files (docs/formats.md). Each reader fills problem (but its name), notes and origin; what all
// layouts share is done once, in problem_file.cpp.
namespace zwang {

// zwang's own layout: the group "zwang" of a problem.
Instance read_own(const hdf5::Group& group);
void write_own(hdf5::Group& group, const Instance& instance);

// FCLIB's groups "fclib_global" or "fclib_global_rolling", and "fclib_local". Without tangent rows where the law wants
// none.
Instance read_fclib_global(const hdf5::Group& group, std::optional<Law> law, bool rolling);
Instance read_fclib_local(const hdf5::Group& group, std::optional<Law> law);

// Siconos' text files of frictional problems: dimension, contacts, then W, q, mu (local) or M, H, q, b, mu (global).
Instance read_siconos(const std::filesystem::path& file, std::optional<Law> law);

// What the p of a sparse matrix's p, i, x counts.
enum class Storage { triplets, columns, rows };

// A matrix of rows x cols from the first `count` entries; duplicates sum. Throws BadFile where an index is out of range
// or an entry is not finite.
SparseMatrix read_sparse(const hdf5::Group& group, Index rows, Index cols, Storage storage, std::size_t count);

// With whatever entries there are; those of a problem's rows are looked at by bad_input().
Vector read_raw(const hdf5::Group& group, const std::string& name, std::size_t size = hdf5::Group::any);
// Throws BadFile where an entry is not finite.
Vector read_vector(const hdf5::Group& group, const std::string& name, std::size_t size);

// What is wrong with a group, said by it.
Fail failing(const hdf5::Group& group);

}  // namespace zwang
