#include <zwang/core/problem/law.h>

#include <stdexcept>
#include <string>

#include <zwang/core/problem/row_writer.h>

namespace zwang {

Law parse_law(std::string_view word) {
  std::string words;
  for (const Law law : all_laws) {
    if (to_string(law) == word) return law;
    words.append(words.empty() ? "" : law == all_laws.back() ? " or " : ", ").append(to_string(law));
  }
  throw std::invalid_argument("no law '" + std::string(word) + "'; expected " + words);
}

std::vector<RowUnder> rows_under(Law law, const Problem& p) {
  std::vector<RowUnder> rows;
  for (Index i = 0; i < p.rows(); ++i) {
    const Index tangents = p.is_equality(i) ? 0 : p.tangents(i);
    const bool slips = tangents > 0 && p.mu[i] > 0;
    if (has_edges(law) && slips) {
      for (int edge = 0; edge < 2 * tangents; ++edge)
        rows.push_back({i, i + 1 + edge / 2, edge % 2 == 0 ? p.mu[i] : -p.mu[i], edge});
    } else {
      rows.push_back({i});
      for (Index t = 1; has_cones(law) && slips && t <= tangents; ++t) rows.push_back({i + t});
    }
    i += tangents;
  }
  return rows;
}

Problem under(Law law, const Problem& p) {
  if (!p.has_tangents()) return p;
  Problem out{.name = p.name, .M = p.M, .z_u = p.z_u};
  RowWriter written;
  for (const RowUnder& row : rows_under(law, p)) {
    const auto old = at(row.normal);
    RowKey key = p.key[old];
    if (row.edge >= 0) key.row += static_cast<std::uint32_t>(row.edge);
    double c = p.c[row.normal];
    if (row.tangent >= 0)
      c = -(row.factor * -p.c[row.tangent] - c);  // FCLIB's -(w_N + mu w_T), to the sign of its zero
    written.add(p.kind[old], key, c, p.kind[old] == RowKind::inequality ? p.mu[row.normal] : 0);
    written.entries(p.J, row.normal);
    if (row.tangent >= 0) written.entries(p.J, row.tangent, row.factor);
  }
  written.write(out);
  out.law = out.has_tangents() || has_edges(law) ? law : no_friction;
  return out;
}

}  // namespace zwang
