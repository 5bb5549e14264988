// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/assignment.h>

#include <vector>

namespace headway::objects {

/// Removes the pairs that belong to an optimal assignment independently of all others.
///
/// Leaving a row or a column unpaired costs 0. A pair is obvious if it costs no more than the best
/// other pair of its row and the best other pair of its column together: were those chosen
/// instead, exchanging them for it would not cost more. In a crowd that is tracked well nearly all
/// pairs are obvious, which splits one large assignment into many small ones.
///
/// @param candidates  each pair once; reduced to those that neither are obvious nor have a row or
///                    column of an obvious one
/// @return            the obvious pairs, in the order of the candidates
[[nodiscard]] std::vector<CandidatePair> takeObviousPairs(std::vector<CandidatePair>& candidates);

}  // namespace headway::objects
