#include "dispatch/contest.hpp"

namespace dyn::benchmark {

template void addOrder<PerJointVariant>(const std::shared_ptr<Memory>&, const char*, int, int, std::vector<Contender>&);
template void addOrder<Monomorphic>(const std::shared_ptr<Memory>&, const char*, int, int, std::vector<Contender>&);

}  // namespace dyn::benchmark
