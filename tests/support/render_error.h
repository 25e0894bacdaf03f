// The error that a request ends with.
#pragma once

#include "core/base/error.h"
#include "core/render/render.h"

#include <string>

namespace lampyris::test {

// Of an InputError; or "no error".
inline std::string error_of(const RenderRequest& request) {
    try {
        render(request);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace lampyris::test
