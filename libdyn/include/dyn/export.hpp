// DYN_API marks what the shared library exports; everything else stays hidden. And what a program must not be compiled with.
#pragma once

#include <version>

#define DYN_API __attribute__((visibility("default")))

// Vectors and strings cross the boundary, laid out as the library was built with them.
#if defined(_GLIBCXX_DEBUG) && !defined(DYN_GLIBCXX_DEBUG)
#error "_GLIBCXX_DEBUG lays out standard containers in another way than this libdyn: use -D_GLIBCXX_ASSERTIONS, or build libdyn with it, too"
#elif defined(_GLIBCXX_RELEASE) && defined(_GLIBCXX_USE_CXX11_ABI) && !_GLIBCXX_USE_CXX11_ABI
#error "_GLIBCXX_USE_CXX11_ABI=0 lays out std::string in another way than libdyn: leave it out"
#elif defined(_LIBCPP_VERSION)
#error "libdyn is built with GNU's standard library, and containers of libc++ are laid out in another way: leave out -stdlib=libc++"
#endif
