# SPDX-License-Identifier: Apache-2.0
# install(): headers, libraries and a package file, so that find_package(hardpack) works.
