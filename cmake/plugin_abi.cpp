// Part of every plugin: the Lampyris for which it was built. The library reads it before it loads the plugin.
#include "core/plugin_abi.h"

extern "C" __attribute__((visibility("default"), used)) const char lampyris_plugin_abi[] =
    "lampyris_plugin_abi=" LAMPYRIS_PLUGIN_ABI;
