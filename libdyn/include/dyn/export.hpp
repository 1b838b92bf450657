// DYN_API marks what the shared library exports; everything else stays hidden.
#pragma once

#define DYN_API __attribute__((visibility("default")))
