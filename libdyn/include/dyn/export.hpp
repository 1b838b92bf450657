// DYN_API marks what the shared library exports; everything else stays hidden.
#pragma once

#if defined(DYN_STATIC)
#define DYN_API
#else
#define DYN_API __attribute__((visibility("default")))
#endif
