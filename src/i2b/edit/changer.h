// What a single change of cells or faces does for a face beyond a limit: merging cells, as the paper does with poor ones (Wang and
// Srinivasan 2002, section 4), or dividing a face. Each is judged on a small mesh of its own, by all that a check names.
#pragma once
#include "i2b/edit/local_edits.h"
#include "i2b/quality/dictionary_measure.h"
#include <array>
#include <optional>
#include <tbb/concurrent_unordered_map.h>
#include <vector>

namespace i2b {

struct Verdict {
    std::array<std::int64_t, dictionaryLimitCount + 9> counts{}; // of all that a check names, but for faces twice there
    std::int64_t faces = 0;   // beyond limits, with those of a boundary that only checkMesh finds too skew
    std::int64_t concave = 0; // cells
    double nonOrthogonality = 0, skewness = 0;                    // degrees; the greatest
};

// Of the groups in question and their faces: what lies around them stays as it is.
Verdict judge(const LocalEdits::Surroundings& around, const DictionaryLimits& dictionary);
// With all that lies around them: is any face beyond a limit?
bool anyBeyond(LocalEdits::Surroundings around, const DictionaryLimits& dictionary);
// Fewer faces beyond limits, and nothing else worse?
bool isBetter(const Verdict& now, const Verdict& before);
// Nothing that a check names worse, and the worst faces as far within the limits as repair leaves others, or no nearer to them than before?
bool isNoWorse(const Verdict& now, const Verdict& was, const DictionaryLimits& limits);
// Faces that are there twice: asked where all else is better, for it takes as long.
std::int64_t facesTwice(const PolyMesh& mesh);
bool hasNoMoreTwice(const PolyMesh& now, const PolyMesh& before);

// Two groups, or one, as they are.
LocalEdits::Trial still(std::int32_t a, std::int32_t b);
void apply(const LocalEdits::Trial& change, LocalEdits& edits);

// Keeps references; the edits must not change while it is used. Any number of threads may ask.
class Changer {
  public:
    using Trial = LocalEdits::Trial;
    // thinFrom: cells from there on are layers that may be flat (LayerStack::areFlat).
    Changer(const PolyMesh& mesh, const LocalEdits& edits, const DictionaryLimits& limits, std::int32_t thinFrom)
        : mesh_(mesh), edits_(edits), limits_(limits), thinFrom_(thinFrom) {}

    // What helps a face with the least change: dividing it, uniting its own two cells, else one of them with the neighbour
    // across its largest face; at last several layers of a column at once.
    std::optional<Trial> find(std::int32_t face) const;
    // Without the last, which takes many trials.
    std::optional<Trial> findSmall(std::int32_t face) const;
    // All that may be done to a face's two cells and their faces, whether it helps or not.
    std::vector<Trial> all(std::int32_t face) const;

  private:
    std::vector<std::int32_t> byFace(std::int32_t group) const; // neighbours, the one across the largest face first
    bool mayUnite(std::int32_t a, std::int32_t b) const;
    struct Meeting {
        bool isLarge = false; // the face between two groups: about the largest of both, as in a column of layers
        bool isWide = false;  // as wide as both together are high, or wider
    };
    Meeting meetingOf(std::int32_t a, std::int32_t b) const;
    std::optional<Trial> unite(std::int32_t a, std::int32_t b) const;
    std::optional<Trial> uniteAll(std::vector<std::int32_t> groups) const;
    bool helps(const Trial& united) const;
    std::vector<std::int32_t> columnOf(std::int32_t group) const;
    std::optional<Trial> uniteColumn(std::int32_t group) const;
    std::vector<Trial> divisionsOf(std::int32_t face) const;
    std::optional<Trial> divide(std::int32_t face, const PolyMesh& whole, const Verdict& before) const;

    const PolyMesh& mesh_;
    const LocalEdits& edits_;
    const DictionaryLimits& limits_;
    std::int32_t thinFrom_;
    struct HashGroups {
        std::size_t operator()(const std::vector<std::int32_t>& groups) const;
    };
    // Of groups that were tried as one, whether that helps: faces of one column ask for the same again and again.
    mutable tbb::concurrent_unordered_map<std::vector<std::int32_t>, bool, HashGroups> tried_;
};

// Two changes that together help a face that none helps alone: the first is any of its cells', the second what then helps.
std::optional<std::array<LocalEdits::Trial, 2>> findPair(const PolyMesh& mesh, std::int32_t face, const DictionaryLimits& limits, std::int32_t thinFrom,
                                                         const LocalEdits& edits);

} // namespace i2b
