#include "face/detector_table.hpp"

#include "model/table_check.hpp"

namespace pliant {

namespace {

static_assert(sizeof(DetectorHeader) == 48 && alignof(DetectorHeader) == 4, "the header has no padding");
static_assert(sizeof(DetectorTree) % 2 == 0 && sizeof(DetectorTree) == 3 * kTreeNodes + kTreeLeaves + 3,
              "a tree has no padding");

bool is_valid(const DetectorTree& tree) {
  for (const std::uint16_t f : tree.feature)
    if (f / 256 >= kWindowCells || f % 256 >= kWindowCells * kCellChannels) return false;
  return tree.reserved == 0;
}

bool is_valid(const DetectorHeader& h) {
  for (int k = 1; k < kScoreKnots; ++k)
    if (h.knot_sum[k] <= h.knot_sum[k - 1] || h.knot_probability[k] < h.knot_probability[k - 1]) return false;
  return h.tree_count > 0 && h.tree_count <= kMostTrees && h.tree_depth == kTreeDepth;
}

}  // namespace

Status DetectorTable::open(Span<const std::uint8_t> bytes, DetectorTable* table) {
  const Status status = check_table(bytes, {kDetectorMagic, 0, sizeof(DetectorHeader)});
  if (status != Status::ok) return status;
  const auto* const header = reinterpret_cast<const DetectorHeader*>(bytes.data);
  if (header->total_bytes != sizeof(DetectorHeader) + header->tree_count * sizeof(DetectorTree))
    return Status::bad_table;
  const Span<const DetectorTree> trees{
      reinterpret_cast<const DetectorTree*>(bytes.data + sizeof(DetectorHeader)), header->tree_count};
  if (!is_valid(*header)) return Status::bad_table;
  for (const DetectorTree& tree : trees)
    if (!is_valid(tree)) return Status::bad_table;
  table->header_ = header;
  table->trees_ = trees;
  return Status::ok;
}

float DetectorTable::probability(int sum) const {
  PLIANT_ASSERT(is_open());
  const auto& x = header_->knot_sum;
  const auto& y = header_->knot_probability;
  constexpr float kUnit = 1.0f / 65535;
  if (sum <= x[0]) return kUnit * static_cast<float>(y[0]);
  for (int k = 1; k < kScoreKnots; ++k) {
    if (sum >= x[k]) continue;
    const float t = static_cast<float>(sum - x[k - 1]) / static_cast<float>(x[k] - x[k - 1]);
    return kUnit * (static_cast<float>(y[k - 1]) + t * static_cast<float>(y[k] - y[k - 1]));
  }
  return kUnit * static_cast<float>(y[kScoreKnots - 1]);
}

int sum_of_trees(Span<const DetectorTree> trees, const std::uint8_t* cells, int stride) {
  int sum = 0;
  for (const DetectorTree& tree : trees) {
    int node = 0;
    for (int level = 0; level < kTreeDepth; ++level) {
      const int feature = tree.feature[node];
      const int value = cells[(feature >> 8) * stride + (feature & 255)];
      node = 2 * node + 1 + (value >= tree.threshold[node] ? 1 : 0);
    }
    sum += tree.leaf[node - kTreeNodes];
    if (sum < tree.rejection) return kRejected;
  }
  return sum;
}

}  // namespace pliant
