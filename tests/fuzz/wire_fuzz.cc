// Samples as DDS hands them over: texts end within their arrays, sequences have the length that they say.
#include <vector>

#include "idl/convert.h"
#include "server/dds/intake/arrival.h"
#include "tests/fuzz/document_checks.h"

using namespace rigcal;

namespace {

const RobotId kRobot("mapper-01");

Edge MadeEdge() {
  Edge edge;
  edge.robot = kRobot;
  edge.frame_a = SensorId("left"), edge.frame_b = SensorId("right");
  edge.uncertainty = FromInformation(Matrix6d::Identity(), UncertaintySource::kGiven, 0);
  edge.method = "given";
  edge.state = EdgeState::kGood;
  edge.id = PushedEdgeId(edge.robot, ContentDigest(edge), 0);
  return edge;
}

const Edge& SampleEdge() {
  static const Edge kEdge = MadeEdge();
  return kEdge;
}

// Fields of a good sample, each replaced where the input says so.
class Patch {
 public:
  explicit Patch(fuzz::Input& input) : input_(input), mask_(input.Number<std::uint32_t>()) {}

  bool Next() { return (mask_ >> bit_++) % 2 == 1; }
  template <std::size_t N>
  void Text(char (&to)[N]) {
    if (!Next()) return;
    const std::string_view text = input_.Text().substr(0, N - 1);
    std::memset(to, 0, N);
    std::copy(text.begin(), text.end(), to);
  }
  template <typename T>
  void Number(T& to) {
    if (Next()) to = input_.Number<T>();
  }
  template <std::size_t N>
  void Numbers(double (&to)[N]) {
    if (!Next()) return;
    for (double& value : to) value = input_.Number<double>();
  }
  // So many entries from the input; whatever there is if it ends.
  template <typename Sequence, typename Item>
  void Items(Sequence& to, std::vector<Item>& memory) {
    if (!Next()) return;
    memory.resize(input_.Number<std::uint8_t>() % 4);
    for (Item& item : memory) {
      const std::string_view bytes = input_.Take(sizeof item);
      if (!bytes.empty()) std::memcpy(static_cast<void*>(&item), bytes.data(), bytes.size());
    }
    to._length = to._maximum = static_cast<std::uint32_t>(memory.size());
    to._buffer = memory.data();
  }

 private:
  fuzz::Input& input_;
  std::uint32_t mask_;
  int bit_ = 0;
};

struct Parts {
  std::vector<rigcal_wire_BlockVector> blocks;
  std::vector<rigcal_wire_Contribution> contributions;
};

// The id that belongs to a sample's content.
void SetId(rigcal_wire_PairwiseResult& sample, const Parts& parts) {
  Edge edge = SampleEdge();
  edge.frame_a = SensorId(sample.frame_a), edge.frame_b = SensorId(sample.frame_b);
  edge.method = sample.method;
  std::copy_n(sample.p_m, 3, edge.T_a_b.p_m.data());
  std::copy_n(sample.q_xyzw, 4, edge.T_a_b.q.coeffs().data());
  for (int i = 0; i < 36; ++i) edge.uncertainty.Omega(i / 6, i % 6) = sample.information[i];
  edge.uncertainty.source = UncertaintySourceOf(sample.source).value_or(UncertaintySource::kGiven);
  edge.uncertainty.dof = sample.dof;
  edge.uncertainty.jackknife_ratio = sample.jackknife_ratio;
  for (const auto& block : parts.blocks)
    edge.uncertainty.blocks.push_back({block.block_id, Vector6d::Map(static_cast<const double*>(block.d))});
  for (const auto& part : parts.contributions) {
    Matrix6d covariance;
    for (int i = 0; i < 36; ++i) covariance(i / 6, i % 6) = part.covariance[i];
    edge.uncertainty.contributions.push_back({part.name, covariance});
  }
  const EdgeId id = PushedEdgeId(RobotId(sample.robot_id), ContentDigest(edge), sample.occurrence_idx);
  std::memcpy(sample.edge_id, id.str().c_str(), id.str().size() + 1);
}

void CheckItem(const wire::BatchItem& item) {
  fuzz::CheckEdge(item.edge);
  if (item.count > 64) return;  // the search for the occurrence is the sender's and grows with the batch
  const auto written = wire::ToPairwiseResult(item);
  if (!written) fuzz::Require(false, "what was read can be written", written.error().what);
  const auto again = wire::FromPairwiseResult(written->sample);
  fuzz::Require(again && again->edge.id == item.edge.id, "an edge keeps its id");
}

template <typename Sample>
void CheckArrival(const Sample& sample, const wire::SampleOrigin& origin) {
  const auto arrival = dds::FromIdl(sample, origin);
  if (!arrival) return;
  fuzz::Require(dds::BytesOf(*arrival) >= 0, "an arrival has a size");
  if (const auto* refusal = std::get_if<dds::Refusal>(&*arrival)) fuzz::RequireError(refusal->error);
}

void Edges(fuzz::Input& input, const wire::SampleOrigin& origin) {
  const wire::BatchItem good{BatchId(std::string(64, 'b')), 0, 1, SampleEdge()};
  auto owned = wire::ToPairwiseResult(good);
  rigcal_wire_PairwiseResult& sample = owned->sample;
  Parts parts;
  Patch patch(input);
  patch.Text(sample.robot_id), patch.Text(sample.batch_id), patch.Text(sample.edge_id);
  patch.Text(sample.frame_a), patch.Text(sample.frame_b), patch.Text(sample.source), patch.Text(sample.method);
  patch.Number(sample.batch_idx), patch.Number(sample.batch_count), patch.Number(sample.occurrence_idx);
  patch.Number(sample.rank), patch.Number(sample.dof), patch.Number(sample.jackknife_ratio);
  patch.Numbers(sample.p_m), patch.Numbers(sample.q_xyzw), patch.Numbers(sample.information);
  patch.Items(sample.blocks, parts.blocks), patch.Items(sample.contributions, parts.contributions);
  for (auto& block : parts.blocks) block.block_id[sizeof block.block_id - 1] = '\0';
  for (auto& part : parts.contributions) part.name[sizeof part.name - 1] = '\0';
  if (patch.Next()) SetId(sample, parts);
  const auto item = wire::FromPairwiseResult(sample);
  if (fuzz::RequireGoodError(item)) CheckItem(*item);
  CheckArrival(sample, origin);
}

void Receipts(fuzz::Input& input) {
  wire::Receipt good;
  good.robot = kRobot, good.subject_id = std::string(64, 'b');
  good.error = Error{ErrorCode::kBusy, "what", "cure"};
  auto owned = wire::ToReceipt(good);
  rigcal_wire_Receipt& sample = owned->sample;
  std::vector<std::uint8_t> held;
  std::vector<rigcal_wire_ChunkRef> busy;
  Patch patch(input);
  patch.Text(sample.robot_id), patch.Text(sample.subject_id), patch.Text(sample.state);
  patch.Number(sample.window_bytes), patch.Number(sample.written_bytes);
  patch.Items(sample.held, held), patch.Items(sample.busy, busy);
  std::string code(input.Text());
  if (patch.Next()) sample.error_code = code.data();
  for (char** text : {&sample.error_code, &sample.what, &sample.cure})
    if (patch.Next()) *text = nullptr;
  const auto receipt = wire::FromReceipt(sample);
  if (!fuzz::RequireGoodError(receipt)) return;
  fuzz::Require(receipt->held.size() == 8 * sample.held._length, "every bit is there");
  fuzz::Require(wire::ToReceipt(*receipt).has_value(), "what was read can be written");
}

template <typename Sample>
void Sessions(fuzz::Input& input, const wire::SampleOrigin& origin) {
  Sample sample{};
  std::strcpy(sample.robot_id, "mapper-01");
  std::memset(sample.session_id, 'a', 64);
  Patch patch(input);
  patch.Text(sample.robot_id), patch.Text(sample.session_id);
  if constexpr (requires { sample.bytes; }) {
    std::vector<std::uint8_t> bytes(input.rest().begin(), input.rest().end());
    sample.bytes = {static_cast<std::uint32_t>(bytes.size()), static_cast<std::uint32_t>(bytes.size()), bytes.data(),
                    false};
    CheckArrival(sample, origin);
  } else {
    CheckArrival(sample, origin);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const auto kind = input.Number<std::uint8_t>();
  wire::SampleOrigin origin;
  if (kind % 2 == 0) origin.partitions = {"robot/mapper-01"};
  if (kind % 16 == 1) origin.partitions = {std::string(input.Text()), "robot/other-02"};
  if (kind / 16 % 5 == 0) Edges(input, origin);
  if (kind / 16 % 5 == 1) Receipts(input);
  if (kind / 16 % 5 == 2) Sessions<rigcal_wire_SessionHeader>(input, origin);
  if (kind / 16 % 5 == 3) Sessions<rigcal_wire_Manifest>(input, origin);
  if (kind / 16 % 5 == 4) Sessions<rigcal_wire_Chunk>(input, origin);
  return 0;
}
