#include <cmath>
#include <cstdio>

#include <zwang/core/files/layouts.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

constexpr const char* blanks = " \t\r\n";

// The words of a text file, one after another.
class Words {
 public:
  explicit Words(const std::filesystem::path& file) : path_(file), text_(read_stored(file).bytes) {}

  std::string_view word(const std::string& what) {
    at_ = text_.find_first_not_of(blanks, at_);
    if (at_ == std::string::npos) fail("ends before " + what);
    const std::size_t begin = at_;
    at_ = std::min(text_.find_first_of(blanks, at_), text_.size());
    ++word_;
    return std::string_view(text_).substr(begin, at_ - begin);
  }
  void expect(std::string_view expected) {
    const std::string quoted = std::string("'").append(expected).append("'");
    if (word(quoted) != expected) fail("expected " + quoted);
  }
  template <class T>
  T number(const std::string& what) {
    std::string_view text = word(what);
    if (text.starts_with('+')) text.remove_prefix(1);
    const std::optional<T> value = number_in<T>(text);
    if (!value) fail("expected " + what);
    if constexpr (std::is_same_v<T, double>)
      if (!std::isfinite(*value)) fail("not finite; expected " + what);
    return *value;
  }
  // Each number takes two characters at least, so a damaged file cannot ask for more than it could hold.
  Index count(const std::string& what) {
    const auto value = number<std::int64_t>(what);
    if (value < 0 || value > std::ssize(text_)) fail(std::to_string(value) + "; expected " + what);
    return value;
  }
  template <class T>
  std::vector<T> numbers(Index count, const std::string& what) {
    std::vector<T> all;
    for (Index k = 0; k < count; ++k) all.push_back(number<T>(what));
    return all;
  }
  Vector vector(Index size, const std::string& what) {
    const auto values = numbers<double>(size, what);
    return Eigen::Map<const Vector>(values.data(), size);
  }
  // What is left of a line.
  std::string line() {
    const std::size_t begin = at_, end = std::min(text_.find('\n', at_), text_.size());
    at_ = std::min(end + 1, text_.size());
    return text_.substr(begin, end - begin);
  }
  // How many words are left.
  Index left() const {
    Index words = 0;
    for (std::size_t at = text_.find_first_not_of(blanks, at_); at != std::string::npos; ++words)
      at = text_.find_first_not_of(blanks, std::min(text_.find_first_of(blanks, at), text_.size()));
    return words;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw BadFile(path_.string() + ": word " + std::to_string(word_) + ": " + what);
  }

 private:
  std::filesystem::path path_;
  std::string text_;
  std::size_t at_ = 0, word_ = 0;
};

using Entries = std::vector<Eigen::Triplet<double>>;

// By columns, as they lie in memory.
Entries read_dense(Words& words, Index rows, Index columns, const std::string& entry) {
  if (words.count("the number of rows again") != rows || words.count("the number of columns again") != columns)
    words.fail("expected " + std::to_string(rows) + " and " + std::to_string(columns) + " again");
  Entries entries;
  for (Index j = 0; j < columns; ++j)
    for (Index i = 0; i < rows; ++i)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(j), words.number<double>(entry));
  return entries;
}

// Their count, the cumulative sizes, a compressed-row index, then each block by columns.
Entries read_blocks(Words& words, Index rows, Index columns, const std::string& entry) {
  const Index blocks = words.count("the number of blocks"), block_rows = words.count("rows of blocks"),
              block_columns = words.count("columns of blocks");
  const auto row_end = words.numbers<std::int64_t>(block_rows, "a cumulative size"),
             column_end = words.numbers<std::int64_t>(block_columns, "a cumulative size");
  const Index filled = words.count("the length of index1"), used = words.count("the length of index2");
  const auto first = words.numbers<std::int64_t>(filled, "an entry of index1"),
             column = words.numbers<std::int64_t>(used, "an entry of index2");
  if (used < blocks) words.fail("index2 has " + std::to_string(used) + " entries; expected " + std::to_string(blocks));
  Entries entries;
  const auto begin_of = [](const std::vector<std::int64_t>& end, std::int64_t k) { return k > 0 ? end[at(k - 1)] : 0; };
  for (Index k = 0; k < blocks; ++k) {
    const Index block = words.count("the number of a block");
    std::int64_t row = 0;
    while (row + 2 < filled && first[at(row + 1)] <= block) ++row;
    if (block >= blocks || column[at(block)] < 0 || column[at(block)] >= block_columns || row >= block_rows)
      words.fail("expected the number of a block below " + std::to_string(blocks));
    const std::int64_t across = column[at(block)], top = begin_of(row_end, row), left = begin_of(column_end, across),
                       bottom = row_end[at(row)], right = column_end[at(across)];
    if (top < 0 || left < 0 || bottom < top || right < left || bottom > rows || right > columns)
      words.fail("block " + std::to_string(block) + " lies outside of the matrix");
    for (Index j = left; j < right; ++j)
      for (Index i = top; i < bottom; ++i)
        entries.emplace_back(static_cast<int>(i), static_cast<int>(j), words.number<double>(entry));
  }
  return entries;
}

// As CSparse prints it: triplets "i j : x", or "col j : locations a to b" and "i : x" for each of them.
Entries read_sparse_text(Words& words, Index rows, Index columns, const std::string& entry) {
  words.count("where the sparse matrix comes from");
  words.expect("CSparse");
  words.line();
  const std::string head = words.line();
  long long m = -1, n = -1, room = 0, used = 0;
  const bool triplets =
      std::sscanf(head.c_str(), " triplet: %lld-by-%lld, nzmax: %lld nnz: %lld", &m, &n, &room, &used) == 4;
  if (!triplets && std::sscanf(head.c_str(), " %lld-by-%lld,", &m, &n) != 2)
    words.fail("then '" + head + "'; expected the size of a matrix in triplets or compressed columns");
  if (m != rows || n != columns)
    words.fail("then '" + head + "'; expected " + std::to_string(rows) + "-by-" + std::to_string(columns));
  Entries entries;
  const auto add = [&](std::int64_t i, std::int64_t j) {
    if (i < 0 || i >= rows || j < 0 || j >= columns)
      words.fail("row " + std::to_string(i) + ", column " + std::to_string(j) + "; expected a place in " +
                 std::to_string(rows) + " x " + std::to_string(columns));
    words.expect(":");
    entries.emplace_back(static_cast<int>(i), static_cast<int>(j), words.number<double>(entry));
  };
  for (long long k = 0; triplets && k < used; ++k) {
    const auto i = words.number<std::int64_t>("a row");
    add(i, words.number<std::int64_t>("a column"));
  }
  for (Index j = 0; !triplets && j < columns; ++j) {
    words.expect("col");
    if (words.count("a column") != j) words.fail("expected column " + std::to_string(j));
    words.expect(":");
    words.expect("locations");
    const auto begin = words.number<std::int64_t>("where the column begins");
    words.expect("to");
    const auto last = words.number<std::int64_t>("where the column ends");
    for (std::int64_t k = begin; k <= last; ++k) add(words.number<std::int64_t>("a row"), j);
  }
  return entries;
}

SparseMatrix read_matrix(Words& words, const std::string& name) {
  const std::string entry = "an entry of " + name;
  const Index storage = words.count("the storage of " + name + ": 0 dense, 1 sparse-block, 2 sparse");
  if (storage > 2)
    words.fail("storage " + std::to_string(storage) + " of " + name +
               "; expected 0 (dense), 1 (sparse-block) or 2 (sparse)");
  const Index rows = words.count("the rows of " + name), columns = words.count("the columns of " + name);
  const Entries entries = storage == 0   ? read_dense(words, rows, columns, entry)
                          : storage == 1 ? read_blocks(words, rows, columns, entry)
                                         : read_sparse_text(words, rows, columns, entry);
  return sparse_of<SparseMatrix>(rows, columns, entries);
}

Vector read_mu(Words& words, Index contacts) {
  const Vector mu = words.vector(contacts, "a friction coefficient");
  if (contacts > 0 && mu.minCoeff() < 0) words.fail("mu is negative; expected a friction coefficient >= 0");
  return mu;
}

}  // namespace

// Both forms begin with the dimension, the number of contacts and a matrix. A local one then has q and mu, a global one
// H, q, b and mu; one more number may follow, which Siconos does not read.
Instance read_siconos(const std::filesystem::path& file, std::optional<Law> law) {
  const Fail fail = [&](const std::string& place, const std::string& what) {
    throw BadFile(file.string() + ": " + place + ": " + what);
  };
  Words words(file);
  const Index dim = words.count("the dimension, 2 or 3");
  if (dim != 2 && dim != 3) words.fail("dimension " + std::to_string(dim) + "; expected 2 or 3");
  const Index contacts = words.count("the number of contacts"), columns = dim * contacts;
  SparseMatrix matrix = read_matrix(words, "W or M");
  const std::string size = std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols());
  if (matrix.rows() != matrix.cols()) words.fail("W or M is " + size + "; expected a square matrix");
  const Index n = matrix.rows(), left = words.left();
  if (n == columns && left <= columns + contacts + 1) {
    LocalForm form{.dim = dim, .W = std::move(matrix), .q = words.vector(n, "an entry of q")};
    form.mu = read_mu(words, contacts);
    if (law && !reads_mu(*law)) form.mu.resize(0);
    return from_local_form(std::move(form), law, fail);
  }
  if (left <= columns + contacts + 1)
    words.fail("W is " + size + "; expected " + std::to_string(columns) + " x " + std::to_string(columns) + ", for " +
               std::to_string(contacts) + " contacts, or M of a global problem and H");
  GlobalForm form{.dim = dim, .sliding = dim - 1, .M = std::move(matrix)};
  form.H = read_matrix(words, "H");
  if (form.H.rows() != n || form.H.cols() != columns)
    words.fail("H is " + std::to_string(form.H.rows()) + " x " + std::to_string(form.H.cols()) + "; expected " +
               std::to_string(n) + " x " + std::to_string(columns) + ", for " + std::to_string(contacts) + " contacts");
  form.G.resize(n, 0);
  form.f = words.vector(n, "an entry of q");
  form.w = words.vector(columns, "an entry of b");
  form.mu = read_mu(words, contacts);
  if (words.left() > 1)
    words.fail("then " + std::to_string(words.left()) + " more words; expected the end of the file");
  if (law && !reads_mu(*law)) form.mu.resize(0);
  return from_global_form(std::move(form), fail);
}

}  // namespace zwang
