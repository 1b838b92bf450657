#include "dispatch/contest.hpp"

namespace dyn::benchmark {

template void addOrder<PerBatch>(const std::shared_ptr<Memory>&, const char*, int, int, std::vector<Contender>&);
template void addOrder<PerJointVirtual>(const std::shared_ptr<Memory>&, const char*, int, int, std::vector<Contender>&);

}  // namespace dyn::benchmark
