#include <zwang/collision/load.h>

#include <gtest/gtest.h>
#include <zlib.h>

#include <chrono>
#include <cstdlib>
#include <fstream>

#include <zwang/bench/collision/meshes.h>
#include "tests/folders.h"
#include "tests/recorded_data.h"

namespace zwang::collision {
namespace {

namespace fs = std::filesystem;

struct MeshFiles : testing::Test {
  fs::path folder = own_path("meshes");
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }
  std::string complaint(const fs::path& file) const {
    try {
      load_tree(file);
    } catch (const BadFile& bad) {
      return bad.what();
    }
    return "";
  }
};

const std::string tetrahedron_obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

std::string binary_stl(const Mesh& mesh) {
  std::string bytes(80, ' ');
  const auto put = [&bytes](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) put(0.0f);
    for (const std::uint32_t v : t)
      for (int k = 0; k < 3; ++k) put(static_cast<float>(mesh.vertices[v][k]));
    put(std::uint16_t{0});
  }
  return bytes;
}

fs::path data() { return test::recorded_data(); }

TEST_F(MeshFiles, FormatsGiveTheSameClosedTetrahedron) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  Mesh shape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  for (const fs::path& file :
       {write("t.obj", tetrahedron_obj), write("t.ply", ply), write("t.STL", binary_stl(shape))}) {
    const MeshFile read = read_mesh(file);
    EXPECT_EQ(read.mesh.vertices.size(), 4u) << file;
    EXPECT_EQ(read.mesh.triangles.size(), 4u) << file;
    EXPECT_EQ(read.report.boundary_edges + read.report.non_manifold_edges, 0u) << file;
    EXPECT_EQ(read.report.high, Vec3(1, 1, 1)) << file;
  }
}

// The float -0.02 begins with 0x0A, a line's end to assimp.
TEST_F(MeshFiles, BinaryPlyMayBeginWithAnyByte) {
  for (const std::string newline : {"\n", "\r\n"})
    for (const float x : {-.02F, .02F}) {
      std::string ply;
      for (const char* line :
           {"ply", "format binary_little_endian 1.0", "element vertex 3", "property float x", "property float y",
            "property float z", "element face 1", "property list uchar int vertex_indices", "end_header"})
        ply += line + newline;
      const std::array<float, 9> points{x, 0, 0, 1, 0, 0, 0, 1, 0};
      const std::array<std::int32_t, 3> corners{0, 1, 2};
      ply.append(reinterpret_cast<const char*>(points.data()), sizeof points);
      ply += '\3';
      ply.append(reinterpret_cast<const char*>(corners.data()), sizeof corners);
      const MeshFile read = read_mesh(write("first.ply", ply));
      EXPECT_EQ(read.report.low.x(), std::min(0.0, static_cast<double>(x)));
      EXPECT_EQ(read.mesh.triangles.size(), 1u);
    }
}

TEST_F(MeshFiles, TextStlMayBeInCapitals) {
  const fs::path file =
      write("capitals.stl",
            "SOLID X\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1.5E0 0 0\nVERTEX 0 1 0\nENDLOOP\n"
            "ENDFACET\nENDSOLID X\n");
  EXPECT_EQ(read_mesh(file).report.high, Vec3(1.5, 1, 0));
}

// assimp passes over such vertices, and the faces' numbers then mean others.
TEST_F(MeshFiles, EveryVertexOfAnObjIsReadOrRefused) {
  const std::string head = "v 0 0 0\nv 2 0 0\n", rest = "v 0 1 0\nv 0 9 0\nf 1 2 4\n";
  for (const std::string third :
       {"v 1 .5 0", "v -.1 +.5 0.", "  v 1 .5 0", "\tv\t1 .5 0 ", "V 1 .5 0", "v 1 .5 0 2", "v 1 .5 0 1 0 0",
        "v 1 .5 0 1 0 0 1", "v 1 .5 0 # 12", "v 1 \\\n.5 0", "v 1 .5 0\r", "v 1 .5 0\r\r", "vt .1 .2\nv 1 .5 0"})
    EXPECT_EQ(read_mesh(write("third.obj", head + third + "\n" + rest)).report.high, Vec3(2, 1, 0)) << third;
  for (const std::string face : {"  f 1 2 4", "F 1 2 4", "f 1/7 2/8/9 4//9 # 5", "f -5 -4 -2", "fo 1 2 4"})
    EXPECT_EQ(read_mesh(write("face.obj", head + "v 1 .5 0\nv 0 1 0\nv 0 9 0\n" + face)).report.high, Vec3(2, 1, 0))
        << face;
  std::string old = head + "v 1 .5 0\n" + rest;
  std::ranges::replace(old, '\n', '\r');
  EXPECT_EQ(read_mesh(write("old.obj", "\xEF\xBB\xBF" + old)).report.high, Vec3(2, 1, 0));
  for (const std::string third : {"v 1 .5", "v 1 .5 0 1 0", "v 1 .5 0 1 0 0 1 1", "v 1 .5 x", "v", "v 1,5 .5 0"})
    EXPECT_NE(
        complaint(write("third.obj", head + third + "\n" + rest)).find("line 3: '" + third + "'; expected v x y z"),
        std::string::npos)
        << third;
}

TEST_F(MeshFiles, AnStlOfTheWrongSizeSaysWhichIsRight) {
  const std::string whole = binary_stl({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}});
  EXPECT_NE(complaint(write("cut.stl", whole.substr(0, 100)))
                .find("100 bytes; expected an STL: text that begins with "
                      "solid, or 184 bytes for 2 triangles"),
            std::string::npos);
  EXPECT_NE(complaint(write("short.stl", "hello")).find("or 84 bytes at least"), std::string::npos);
}

TEST_F(MeshFiles, GzipIsInflatedAndUnitsScale) {
  const fs::path file = folder / "t.obj.gz";
  gzFile out = gzopen(file.c_str(), "wb");
  gzwrite(out, tetrahedron_obj.data(), static_cast<unsigned>(tetrahedron_obj.size()));
  gzclose(out);
  EXPECT_NEAR(read_mesh(file, {.unit = metres_per("mm")}).report.high.x(), 1e-3, 1e-12);
  EXPECT_THROW(metres_per("mn"), std::invalid_argument);
}

TEST_F(MeshFiles, BrokenFilesCostOneLineThatNamesTheFile) {
  const std::string solid = "solid x\nnothing here\nendsolid x\n";
  for (const fs::path& file :
       {write("empty.stl", ""), write("text.stl", "this is no mesh, only text\n"), write("text2.stl", solid),
        write("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), write("range.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n"),
        write("range.ply",
              "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
              "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 "
              "0\n0 1 0\n3 0 1 7\n"),
        write("points.ply",
              "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
              "float z\nend_header\n0 0 0\n"),
        write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), write("torn.obj.gz", "\x1f\x8b\x08 torn"),
        write("mesh.step", "ISO-10303-21;"), write("half.glb", "glTF\x02"), folder, folder / "absent.stl"}) {
    const std::string line = complaint(file);
    EXPECT_NE(line.find(file.string()), std::string::npos) << file << ": " << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    EXPECT_GT(line.size(), file.string().size() + 4) << line;
  }
}

// assimp 5.2.5 reads on for ever in a binary PLY that ends within its header.
TEST_F(MeshFiles, APlyCutWithinItsHeaderIsRefusedAtOnce) {
  const std::string head =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 4\nproperty list uchar int vertex_indices\n";
  for (std::size_t size = 4; size < head.size(); size += 17) {
    const std::string line = complaint(write("cut.ply", head.substr(0, size)));
    EXPECT_NE(line.find("cut.ply: cut within its header"), std::string::npos) << size << ": " << line;
  }
  // The words are there, but no line that ends the header.
  const auto start = std::chrono::steady_clock::now();
  EXPECT_NE(complaint(write("comment.ply", "ply\nformat binary_little_endian 1.0\ncomment end_header")), "");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
}

// assimp takes what is there for the whole mesh: a cut file loses triangles and nobody is told.
TEST_F(MeshFiles, TextThatEndsEarlyIsRefused) {
  const auto facet = [](const char* corner) {
    return std::string("facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex ") + corner +
           "\nendloop\nendfacet\n";
  };
  const std::string stl = "solid a\n" + facet("0 1 0") + facet("0 0 1");
  for (const std::string ending : {"endsolid a\n", "endsolid", "end solid a\n"})
    EXPECT_EQ(complaint(write("whole.stl", stl + ending)), "") << ending;
  for (std::size_t size = 8; size <= stl.size(); ++size)
    EXPECT_NE(complaint(write("cut.stl", stl.substr(0, size))), "") << size;
  EXPECT_NE(complaint(write("cut.stl", stl)).find("cut: no line endsolid at its end"), std::string::npos);

  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\nelement edge 0\n"
      "property int vertex1\nend_header\n";
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n", ply = head + points + "3 0 1 2 9\n\n3 0 2 1 9";
  EXPECT_EQ(complaint(write("whole.ply", ply)), "");
  for (std::size_t size = head.size(); size < ply.size(); ++size)
    EXPECT_NE(complaint(write("cut.ply", ply.substr(0, size))).find("cut: "), std::string::npos) << size;
  EXPECT_NE(complaint(write("cut.ply", head + points)).find("3 lines of data; expected 5 whole ones"),
            std::string::npos);

  const std::string face =
      "0\n3DFACE\n8\n0\n10\n0\n20\n0\n30\n0\n11\n1\n21\n0\n31\n0\n12\n0\n22\n1\n32\n0\n13\n0\n23\n1\n33\n0\n";
  const std::string dxf = "0\nSECTION\n2\nENTITIES\n" + face + face + "0\nENDSEC\n0\n";
  EXPECT_EQ(complaint(write("whole.dxf", dxf + "EOF\n")), "");
  for (const std::string& cut : {dxf, dxf.substr(0, dxf.size() - face.size())})
    EXPECT_NE(complaint(write("cut.dxf", cut)).find("cut: no EOF at its end"), std::string::npos);
}

// assimp crashes there.
TEST_F(MeshFiles, AnElementBeforeTheVerticesIsPassedOver) {
  const std::string camera = "element camera 2\nproperty float x\nproperty uchar y\nproperty double z\n",
                    rest =
                        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                        "element face 1\nproperty list uchar uint vertex_indices\n";
  const std::string text =
                        "ply\nformat ascii 1.0\n" + camera + rest + "end_header\n1 2 3\n4 5 6\n0 0 0\n1 0 0\n0 1 0\n",
                    face = "3 0 1 2\n";
  for (const float first : {0.0f, -0.02f}) {
    const std::array<float, 9> points{first, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::array<std::uint32_t, 3> corners{0, 1, 2};
    std::string binary =
        "ply\nformat binary_little_endian 1.0\n" + camera + rest + "end_header\n" + std::string(26, '\n');
    binary.append(reinterpret_cast<const char*>(points.data()), sizeof points) += '\3';
    binary.append(reinterpret_cast<const char*>(corners.data()), sizeof corners);
    const MeshFile read = read_mesh(write("camera.ply", binary));
    ASSERT_EQ(read.mesh.vertices.size(), 3u);
    EXPECT_EQ(read.mesh.vertices[0][0], first);
    EXPECT_EQ(read.mesh.triangles.size(), 1u);
  }
  const MeshFile read = read_mesh(write("camera.ply", text + face));
  EXPECT_EQ(read.mesh.vertices.size(), 3u);
  EXPECT_EQ(read.report.high, Vec3(1, 1, 0));
  EXPECT_NE(complaint(write("cut.ply", text)).find("cut: 3 lines of data; expected 4 whole ones"), std::string::npos);
  const std::string empty = "ply\nformat ascii 1.0\n" + camera + rest + "end_header\n1 2 3";
  EXPECT_NE(complaint(write("cut.ply", empty)).find("cut before its data"), std::string::npos);
  const std::string lists =
      "ply\nformat binary_little_endian 1.0\nelement strip 1\nproperty list uchar int a\n" + rest + "end_header\n";
  EXPECT_NE(complaint(write("lists.ply", lists)).find("its element strip, which has lists"), std::string::npos);
}

TEST_F(MeshFiles, AQuaternionOfAnotherLengthThanOneIsRefused) {
  const auto turned =
      [&](const std::string& rotation) {
        return complaint(write("turned.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"mesh": 0, "rotation" : [ )" + rotation +
                                                  R"( ]}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0}]}],
      "buffers": [{"byteLength": 44, "uri": "data:application/octet-stream;base64,AAABAAIAAAAAAAAAAAAAAAAAAAAAAI)"
                                                  R"(A/AAAAAAAAAAAAAAAAAACAPwAAAAA="}],
      "bufferViews": [{"buffer": 0, "byteLength": 6}, {"buffer": 0, "byteOffset": 8, "byteLength": 36}],
      "accessors": [{"bufferView": 0, "componentType": 5123, "count": 3, "type": "SCALAR"},
                    {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"}]})"));
      };
  for (const char* sound : {"0, 0, 0, 1", "0.707,0,0,0.707", "0.5 , -0.5,\n 0.5 , 0.5"})
    EXPECT_EQ(turned(sound), "") << sound;
  for (const char* other : {"0, 0, 0, 2", "0.71, 0, 0, 0.71", "0, 0, 0, 0", "0.6, 0, 0, 1"})
    EXPECT_NE(turned(other).find("a rotation by a quaternion of length "), std::string::npos) << other;
}

TEST_F(MeshFiles, WhatAssimpWouldReadWronglyIsRefused) {
  const std::string strip =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 2 3\n";
  EXPECT_NE(complaint(write("strip.ply", strip)).find("its triangles are strips"), std::string::npos);
  const std::string gltf = R"({"asset": {"version": "2.0"}, "extensionsRequired" : ["KHR_mesh_quantization"]})";
  EXPECT_NE(complaint(write("small.gltf", gltf)).find("requires KHR_mesh_quantization"), std::string::npos);
}

TEST_F(MeshFiles, NamesMayCarryTheirUnit) {
  EXPECT_EQ(parse_mesh_name("gear.stl@mm").file, "gear.stl");
  EXPECT_EQ(parse_mesh_name("gear.stl@mm").unit, 1e-3);
  EXPECT_EQ(parse_mesh_name("gear.stl").unit, 1);
  EXPECT_THROW(parse_mesh_name("gear.stl@mn"), BadFile);
  const fs::path file = write("gear@mm", "x");
  EXPECT_EQ(parse_mesh_name(file.string()).file, file) << "a file of this very name";
}

TEST(Clean, CountsWhatItDropsAndWhatItSees) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {9, 9, 9}},
            {{0, 1, 2}, {3, 1, 2}, {1, 4, 2}, {0, 1, 5}, {1, 1, 2}}};
  const MeshReport r = clean(mesh);
  EXPECT_EQ(r.welded, 1u);
  EXPECT_EQ(r.repeated, 1u);
  EXPECT_EQ(r.degenerate, 2u);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(r.boundary_edges, 4u);
  EXPECT_EQ(r.non_manifold_edges, 0u);
}

TEST(Clean, WeldsAcrossTheBordersOfItsGrid) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1 + 4e-7, -3e-7, 0}, {-4e-7, 1, 5e-7}, {1, 1, 0}},
            {{0, 1, 2}, {3, 5, 4}}};
  EXPECT_EQ(clean(mesh, 1e-6).welded, 2u);
  EXPECT_EQ(mesh.vertices.size(), 4u);
}

TEST(ProceduralMeshes, AreClosedAndOfTheSizeAskedFor) {
  for (Mesh mesh : {meshes::plate({0.2, 0.1, 0.01}, 2000), meshes::perforated({0.2, 0.2, 0.01}, 4, 5000),
                    meshes::pipe(0.03, 0.004, 0.1, 3000), meshes::gear(0.05, 0.01, 12, 5000),
                    meshes::bumpy_sphere(0.05, 0.004, 7, 4000)}) {
    const MeshReport r = clean(mesh);
    EXPECT_EQ(r.boundary_edges, 0u) << to_string(r);
    EXPECT_EQ(r.degenerate + r.repeated, 0u) << to_string(r);
    EXPECT_GT(mesh.triangles.size(), 1500u);
    EXPECT_LT(mesh.triangles.size(), 8000u);
  }
}

TEST(Tree, HoldsEveryTriangleInBoxesRoundedOutward) {
  const Mesh mesh = meshes::bumpy_sphere(0.05, 0.004, 7, 20000);
  const Tree tree(mesh);
  ASSERT_EQ(tree.size(), mesh.triangles.size());
  std::vector<int> seen(mesh.triangles.size());
  const auto inside = [](const TreeNode& node, const Vec3& p) {
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      if (p[k] < node.low[i] || p[k] > node.high[i]) return false;
    }
    return true;
  };
  std::vector<std::uint32_t> above;
  for (std::uint32_t i = 0; i < tree.nodes().size(); ++i) {
    while (!above.empty() && tree.nodes()[above.back()].skip <= i) above.pop_back();
    above.push_back(i);
    for (auto [t, end] = tree.range(i); tree.leaf(i) && t < end; ++t) {
      ++seen[tree.origin(t)];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = tree.triangle(t).corner[k];
        EXPECT_EQ(p, mesh.vertices[mesh.triangles[tree.origin(t)][k]]);
        for (const std::uint32_t n : above) EXPECT_TRUE(inside(tree.nodes()[n], p));
      }
    }
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size()));
  EXPECT_LE(tree.bytes_per_triangle(), 150);
  RecordProperty("bytes_per_triangle", std::to_string(tree.bytes_per_triangle()));
}

TEST(Tree, ComesBackBitForBitAndRefusesTornBytes) {
  const Tree tree(meshes::gear(0.05, 0.01, 12, 5000));
  const std::string bytes = tree.to_bytes();
  EXPECT_EQ(Tree::from_bytes(bytes).to_bytes(), bytes);
  EXPECT_THROW(Tree::from_bytes(std::string_view(bytes).substr(0, bytes.size() - 1)), std::runtime_error);
  for (const std::size_t at : {std::size_t{3}, std::size_t{70}, bytes.size() / 2}) {
    std::string changed = bytes;
    changed[at] ^= 1;
    EXPECT_THROW(Tree::from_bytes(changed), std::runtime_error) << at;
  }
}

TEST_F(MeshFiles, WhatSinglePrecisionSpoilsIsRefused) {
  const std::string faces = tetrahedron_obj.substr(tetrahedron_obj.find('f'));
  const auto said = [&](const std::string& x) {
    return complaint(write(
        "far.obj", "v " + x + ".03 0 0\nv " + x + ".09 0 0\nv " + x + ".03 0.06 0\nv " + x + ".03 0 0.06\n" + faces));
  };
  EXPECT_NE(said("1000000").find("single precision spoils it; expected it nearer"), std::string::npos);
  EXPECT_EQ(said("10"), "");
}

TEST_F(MeshFiles, CacheAnswersTheSecondTimeWithTheSameTree) {
  const fs::path file = write("sphere.stl", binary_stl(meshes::bumpy_sphere(0.05, 0.004, 7, 20000)));
  const MeshFileOptions options{.unit = 0.5, .cache = folder / "cache"};
  const LoadedTree first = load_tree(file, options), second = load_tree(file, options);
  EXPECT_FALSE(first.cached);
  EXPECT_TRUE(second.cached);
  EXPECT_EQ(first.tree.to_bytes(), second.tree.to_bytes());
  EXPECT_EQ(to_string(first.report), to_string(second.report));
  EXPECT_FALSE(load_tree(file, {.unit = 1, .cache = folder / "cache"}).cached) << "another unit is another tree";
  for (const char* name : {"sphere.ply", "sphere.stl.gz"}) {
    fs::copy_file(file, folder / name);
    EXPECT_THROW(load_tree(folder / name, options), BadFile) << name << " is no such file, whoever read it as another";
  }
  for (const auto& entry : fs::directory_iterator(folder / "cache")) fs::resize_file(entry.path(), 1000);
  const LoadedTree third = load_tree(file, options);
  EXPECT_FALSE(third.cached);
  EXPECT_EQ(first.tree.to_bytes(), third.tree.to_bytes());
}

TEST_F(MeshFiles, AMillionTrianglesAreRead) {
  const fs::path file = write("million.stl", binary_stl(meshes::bumpy_sphere(0.2, 0.01, 9, 1000000)));
  const auto start = std::chrono::steady_clock::now();
  const LoadedTree loaded = load_tree(file);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_GT(loaded.tree.size(), 990000u);
  RecordProperty("seconds", std::to_string(seconds));
}

TEST(RealMeshes, LoadWithTheirKnownSizes) {
  if (!fs::exists(data() / "mesh_differential")) GTEST_SKIP() << data() << " is not there";
  struct Known {
    const char* file;
    double unit;
    std::size_t triangles;
  };
  for (const Known& k : {Known{"mesh_differential/diff_ring.stl", 1e-3, 57640},
                         {"mesh_v6engine/piston.dxf", 1, 2836},
                         {"mesh_factory_parts/factory_bolt_m8_loose.obj.gz", 1, 29478},
                         {"mesh_cad_misc/cycloidal.ply.gz", 1e-3, 43368},
                         {"mesh_cad_misc/counter.unitsmm.STL.gz", 1e-3, 83750},
                         {"mesh_cad_misc/ADIS16480.STL.gz", 1, 7436},
                         {"hand_webxr_generic/left.glb", 1, 0}}) {
    const LoadedTree loaded = load_tree(data() / k.file, {.unit = k.unit});
    const MeshReport& r = loaded.report;
    EXPECT_TRUE(k.triangles == 0 || r.triangles_read == k.triangles) << k.file << ": " << r.triangles_read;
    EXPECT_EQ(loaded.tree.size() + r.degenerate + r.repeated, r.triangles_read) << k.file;
    EXPECT_LE(loaded.tree.bytes_per_triangle(), 150) << k.file;
    std::printf("%s: %s\n", k.file, to_string(r).c_str());
  }
}

}  // namespace
}  // namespace zwang::collision
