#include "core/base/version.h"

namespace lampyris {

const char* version() { return LAMPYRIS_VERSION; }

}  // namespace lampyris
