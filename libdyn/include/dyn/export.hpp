// SPDX-License-Identifier: BSD-2-Clause
// DYN_API, and a refusal of compiler options that change the layout of standard containers.
#pragma once

#include <version>

/// Marks the symbols that the shared library exports; all others stay hidden.
#define DYN_API __attribute__((visibility("default")))

// Vectors and strings cross the library's boundary, so the program must lay them out as the library does.
#if defined(_GLIBCXX_DEBUG) && !defined(DYN_GLIBCXX_DEBUG)
#error "_GLIBCXX_DEBUG lays out standard containers in another way than this libdyn: use -D_GLIBCXX_ASSERTIONS, or build libdyn with it, too"
#elif defined(_GLIBCXX_RELEASE) && defined(_GLIBCXX_USE_CXX11_ABI) && !_GLIBCXX_USE_CXX11_ABI
#error "_GLIBCXX_USE_CXX11_ABI=0 lays out std::string in another way than libdyn: leave it out"
#elif defined(_LIBCPP_VERSION)
#error "libdyn is built with GNU's standard library, and containers of libc++ are laid out in another way: leave out -stdlib=libc++"
#endif
