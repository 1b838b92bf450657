// SPDX-License-Identifier: BSD-2-Clause
// The tests' precompiled headers need a source of their own; CMakeLists.txt names the headers.
