#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the packages of FOLDER in an empty Debian, uses them as their users do, removes them, and configures their
# build with their build dependencies. As root. Usage: in_debian.sh FOLDER CONSUMER_PROJECT SUITE TREE
set -euo pipefail
folder=$1
project=$2
suite=$3
tree=$4
here=$(cd "$(dirname "$0")" && pwd)
source "$here/tree.sh"

make_tree "$suite" "$tree"
rm -rf "$tree/packages" "$tree/project" "$tree/source" "$tree/home/user"
mkdir -p "$tree/packages"
cp "$folder"/*.deb "$here/use.sh" "$here/configure.sh" "$here/../style/document_links.py" \
  "$tree/packages"
cp -r "$project" "$tree/project"
in_tree "$tree" bash /packages/use.sh
mkdir "$tree/source"
tar -C "$folder/headway" --exclude=./build -cf - . | tar -C "$tree/source" -xf -
in_tree "$tree" bash /packages/configure.sh
