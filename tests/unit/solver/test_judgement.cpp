// SPDX-License-Identifier: GPL-3.0-or-later
// What laws say of their own parameters: every rule from both sides, and against what it is for.
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <variant>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

#include "solver/material/judgement.h"
#include "tests/unit/solver/laws.h"

namespace pneuma::tests {
namespace {

using namespace solver::material;
using testing::HasSubstr;
using testing::StartsWith;

using Stated = std::variant<StVenantKirchhoff, Orthotropic, MooneyRivlin, Ogden, Plasticity>;

std::vector<Fault> faults_of(const Stated& law) {
  return std::visit([](const auto& one) { return faults(one); }, law);
}

bool has_error(const Stated& law) {
  const std::vector<Fault> found = faults_of(law);
  return std::any_of(found.begin(), found.end(), [](const Fault& fault) { return fault.error; });
}

Ogden ogden(std::initializer_list<Ogden::Term> terms) {
  Ogden law;
  for (const Ogden::Term& term : terms) law.terms[static_cast<std::size_t>(law.count++)] = term;
  return law;
}

Plasticity plastic(std::vector<HardeningBranch> hardening, bool softening = false, Viscosity viscosity = {}) {
  return {{1e9, 0.4}, std::move(hardening), ModulusKind::plastic, softening, viscosity};
}

Plasticity tangent(Plasticity law) {
  law.modulus = ModulusKind::tangent;
  return law;
}

// Flows from `threshold` on; falls from 15 to 5 MPa where it softens.
Plasticity creeping(double threshold, bool softens = false) {
  const std::vector<HardeningBranch> falls = {{15e6, -90e6}, {5e6, 0}}, rises = {{15e6, 1e6}};
  return plastic(softens ? falls : rises, softens, {Overstress::peric, 300, 0.1, threshold});
}

struct BadLaw {
  const char* claim;
  Stated law;
  const char* parameter;
  const char* message;
  bool error = true;
};

void PrintTo(const BadLaw& law, std::ostream* out) {
  *out << law.claim;
}

class LawAtFault : public testing::TestWithParam<BadLaw> {};

TEST_P(LawAtFault, NamesTheParameterAndSaysWhatIsWrong) {
  const std::vector<Fault> found = faults_of(GetParam().law);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].parameter, GetParam().parameter);
  EXPECT_THAT(found[0].message, HasSubstr(GetParam().message));
  EXPECT_EQ(found[0].error, GetParam().error);
}

const BadLaw bad_laws[] = {
    {"NoStiffness", StVenantKirchhoff{0, 0.45}, "E", "`E` must be positive, not 0 MPa"},
    {"StiffnessThatIsNoNumber", StVenantKirchhoff{std::nan(""), 0.45}, "E", "`E` must be a finite number, not nan MPa"},
    {"VolumeThatGrowsUnderPressure", StVenantKirchhoff{9e8, 0.51}, "nu", "`nu` must be above -1, up to 0.5, not 0.51"},
    {"ABitMoreThanIncompressible", StVenantKirchhoff{9e8, 0.50000001}, "nu", "up to 0.5, not 0.50000001"},
    {"OrthotropicWithoutShear", Orthotropic{9e8, 8e8, 0.4, 0}, "G12", "`G12` must be positive, not 0 MPa"},
    {"OrthotropicWithoutEnergy", Orthotropic{4e8, 9e8, 0.7, 3e8}, "nu12",
     "`nu12` must be between -0.6667 and 0.6667, the square root of E1 / E2, not 0.7: otherwise some strain has no "
     "positive energy; is it meant for tension along the other axis, nu21?"},
    {"RubberWithoutStiffness", MooneyRivlin{0, 1e6}, "C1", "`C1` must be positive, not 0 MPa"},
    {"RubberOfNegativeSecondConstant", MooneyRivlin{1e6, -1e5}, "C2", "`C2` must be at least 0 Pa, not -0.1 MPa"},
    {"OgdenWithoutTerms", ogden({}), "terms", "`terms` must have 1 to 8 entries, not 0"},
    {"OgdenOfMoreTermsThanItHolds", Ogden{9, {}}, "terms", "`terms` must have 1 to 8 entries, not 9"},
    {"OgdenWithoutExponent", ogden({{1e6, 2}, {1e6, 0}}), "terms.1.alpha", "`alpha` must not be 0"},
    {"OgdenTermWithoutEffect", ogden({{0, 2}, {1e6, 2}}), "terms.0.mu", "`mu` must not be 0"},
    {"OgdenWithoutStiffness", ogden({{-1e6, 2}}), "terms",
     "the shear modulus, half the sum of mu alpha, must be positive, not -1 MPa"},
    {"OgdenUnstable", ogden({{6e6, 2}, {-1e6, 4}}), "terms",
     "its Ogden constants are unstable, more strain needs less stress, in uniaxial tension at stretches from 0.25 to "
     "0.333, "},
    {"OgdenTermOfTwoSigns", ogden({{6e6, 2}, {-1e6, 2}}), "terms.1",
     "`mu` -1 MPa and `alpha` 2 have different signs: such a term may make the foil unstable", false},
    {"NoBranch", plastic({}), "hardening", "`hardening` must have at least one branch"},
    {"PlasticPoissonsRatio", Plasticity{{1e9, 0.51}, {{15e6, 1e6}}}, "nu", "`nu` must be above -1, up to 0.5"},
    {"NoYieldStress", plastic({{15e6, 1e6}, {0, 1e6}}), "hardening.1.stress", "`stress` must be positive, not 0 MPa"},
    {"YieldStressesThatDoNotRise", plastic({{21e6, 72e6}, {15e6, 40e6}}), "hardening.1.stress",
     "yield stresses must rise from branch to branch: 15 MPa after 21 MPa"},
    {"LevelBranchBeforeAnother", plastic({{15e6, 0}, {21e6, 40e6}}), "hardening.0.modulus",
     "a branch of modulus 0 MPa never comes to the next one's yield stress, 21 MPa; only the last branch may be level"},
    {"BranchWithoutEnd", plastic({{15e6, 1e-310}, {21e6, 40e6}}), "hardening.0.modulus", "never comes to the next"},
    {"UnannouncedSoftening", plastic({{15e6, -20e6}, {12e6, 0}}), "hardening.0.modulus",
     "a modulus of -20 MPa means softening: strains then gather in one row of elements and results depend on the "
     "mesh; say `softening: on` if it is meant"},
    {"SofteningWithoutEnd", plastic({{15e6, -20e6}}, true), "hardening.0.modulus",
     "the last branch must not soften: it would end below a yield stress of zero"},
    {"SofteningThatRises", plastic({{15e6, -20e6}, {16e6, 0}}, true), "hardening.1.stress",
     "after a branch that softens the yield stress must be lower: 16 MPa after 15 MPa"},
    {"SofteningTooSteep", plastic({{15e6, -900e6}, {12e6, 0}}, true), "hardening.0.modulus",
     "the yield stress falls too steeply: as a plastic modulus -900 MPa, which must be above -833.3 MPa"},
    {"SofteningTooSteepAsATangent", tangent(plastic({{15e6, -9e9}, {12e6, 0}}, true)), "hardening.0.modulus",
     "as a plastic modulus -900 MPa"},
    {"TangentModulusOfElasticity", tangent(plastic({{15e6, 1e9}})), "hardening.0.modulus",
     "a tangent modulus must be below E, 1000 MPa, not 1000 MPa; is it a plastic modulus? then say `modulus: "
     "plastic`"},
    {"NoTimeScale", plastic({{15e6, 1e6}}, false, {Overstress::peric, 0, 1, {}}), "viscosity.mu",
     "`mu` must be positive, not 0 s"},
    {"NoSensitivity", plastic({{15e6, 1e6}}, false, {Overstress::perzyna, 1, 0, {}}), "viscosity.epsilon",
     "`epsilon` must be above 0, up to 10, not 0"},
    {"ThresholdAboveYield", creeping(16e6), "viscosity.threshold",
     "`threshold` must be at most the first yield stress, 15 MPa, not 16 MPa: without it the foil flows from there on"},
    {"ThresholdThatSofteningTakes", creeping(10e6, true), "viscosity.threshold",
     "`threshold` must be above 10 MPa, by which the softening lowers the yield stress, not 10 MPa: the foil would "
     "flow without stress"}};

INSTANTIATE_TEST_SUITE_P(Cases, LawAtFault, testing::ValuesIn(bad_laws),
                         [](const auto& used) { return std::string(used.param.claim); });

TEST(Judgement, TellsAllNumbersThatAreWrongByThemselvesAtOnce) {
  Plasticity law = plastic({{-1, 1e6}, {2e6, std::nan("")}}, false, {Overstress::peric, -1, 11, -1});
  law.elasticity = {0, 1};
  std::vector<std::string> told;
  for (const Fault& fault : faults(law)) told.push_back(fault.parameter);
  EXPECT_EQ(told, (std::vector<std::string>{"E", "nu", "hardening.0.stress", "hardening.1.modulus", "viscosity.mu",
                                            "viscosity.epsilon", "viscosity.threshold"}));
  law.viscosity.model = Overstress::none;
  EXPECT_EQ(faults(law).size(), 4u);
}

TEST(Judgement, FindsNothingInLawsThatAreUsed) {
  const Stated good[] = {StVenantKirchhoff{900e6, 0.45},
                         Orthotropic{900e6, 100e6, 2.9, 300e6}, // narrower by more than one half
                         MooneyRivlin{3e6, 0},
                         ogden({{0.63e6, 1.3}, {0.0012e6, 5}, {-0.01e6, -2}}), // Treloar's rubber
                         plastic({{15e6, 72e6}, {21e6, 40e6}}),
                         plastic({{15e6, 1e12}}), // a plastic modulus may exceed E
                         tangent(plastic({{15e6, 72e6}, {21e6, -20e6}, {18e6, 0}}, true)),
                         creeping(1.5e6)};
  for (const Stated& law : good) EXPECT_TRUE(faults_of(law).empty()) << law.index();
}

// A parameter, and where a rule ends.
struct Border {
  const char* claim;
  const char* parameter; // that is told
  std::function<Stated(double)> law;
  double at = 0;
  bool above = true;   // allowed above, otherwise below
  bool itself = false; // allowed
  double step = 0;     // relative; 0: the next number
};

void PrintTo(const Border& border, std::ostream* out) {
  *out << border.claim;
}

class RuleOfALaw : public testing::TestWithParam<Border> {};

TEST_P(RuleOfALaw, EndsAtItsBorder) {
  const Border& border = GetParam();
  const auto beside = [&](double side) {
    if (border.step > 0) return border.at + side * border.step * std::abs(border.at);
    return std::nextafter(border.at, side * std::numeric_limits<double>::infinity());
  };
  const double inwards = border.above ? 1 : -1;
  EXPECT_FALSE(has_error(border.law(beside(inwards))));
  EXPECT_EQ(has_error(border.law(border.at)), !border.itself);
  const std::vector<Fault> beyond = faults_of(border.law(beside(-inwards)));
  ASSERT_EQ(beyond.size(), 1u);
  EXPECT_EQ(beyond[0].parameter, border.parameter);
}

TEST_P(RuleOfALaw, NamesTheParameterThatIsNoFiniteNumber) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double value : {std::nan(""), infinity, -infinity}) {
    const std::vector<Fault> found = faults_of(GetParam().law(value));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_THAT(found[0].parameter, StartsWith(GetParam().parameter));
    EXPECT_THAT(found[0].message, HasSubstr("must be a finite number, not "));
  }
}

const Border borders[] = {
    {"E", "E",
     [](double x) {
       return StVenantKirchhoff{x, 0.4};
     }},
    {"NuFromBelow", "nu",
     [](double x) {
       return StVenantKirchhoff{9e8, x};
     },
     -1},
    {"NuFromAbove", "nu",
     [](double x) {
       return StVenantKirchhoff{9e8, x};
     },
     0.5, false, true},
    {"E1", "E1",
     [](double x) {
       return Orthotropic{x, 8e8, 0, 3e8};
     }},
    {"E2", "E2",
     [](double x) {
       return Orthotropic{8e8, x, 0.4, 3e8};
     }},
    {"G12", "G12",
     [](double x) {
       return Orthotropic{9e8, 8e8, 0.4, x};
     }},
    {"Nu12FromBelow", "nu12",
     [](double x) {
       return Orthotropic{1e9, 1e9, x, 3e8};
     },
     -1},
    {"Nu12FromAbove", "nu12",
     [](double x) {
       return Orthotropic{1e9, 1e9, x, 3e8};
     },
     1, false},
    {"Nu12OfTwoModuli", "nu12",
     [](double x) {
       return Orthotropic{9e8, 1e8, x, 3e8};
     },
     3, false},
    {"C1", "C1",
     [](double x) {
       return MooneyRivlin{x, 1e6};
     }},
    {"C2", "C2",
     [](double x) {
       return MooneyRivlin{1e6, x};
     },
     0, true, true},
    {"OgdenExponent", "terms.0.alpha",
     [](double x) {
       return ogden({{1e6, x}});
     },
     100, false, true},
    {"OgdenNegativeExponent", "terms.0.alpha",
     [](double x) {
       return ogden({{-1e6, x}});
     },
     -100, true, true},
    {"OgdenShearModulus", "terms",
     [](double x) {
       return ogden({{1e6, 2}, {x, 2}});
     },
     -1e6, true, false, 1e-9},
    {"PlasticE", "E",
     [](double x) {
       return Plasticity{{x, 0.4}, {{15e6, 1e6}}};
     }},
    {"PlasticNuFromBelow", "nu",
     [](double x) {
       return Plasticity{{1e9, x}, {{15e6, 1e6}}};
     },
     -1},
    {"PlasticNuFromAbove", "nu",
     [](double x) {
       return Plasticity{{1e9, x}, {{15e6, 1e6}}};
     },
     0.5, false, true},
    {"YieldStress", "hardening.0.stress",
     [](double x) {
       return plastic({{x, 1e6}});
     }},
    {"TangentModulus", "hardening.0.modulus",
     [](double x) {
       return tangent(plastic({{15e6, x}}));
     },
     1e9, false},
    {"Rise", "hardening.1.stress",
     [](double x) {
       return plastic({{15e6, 72e6}, {x, 1e6}});
     },
     15e6},
    {"Fall", "hardening.1.stress",
     [](double x) {
       return plastic({{15e6, -72e6}, {x, 1e6}}, true);
     },
     15e6, false},
    {"LastModulus", "hardening.0.modulus",
     [](double x) {
       return plastic({{15e6, x}}, true);
     },
     0, true, true},
    {"ModulusWithoutSoftening", "hardening.0.modulus",
     [](double x) {
       return plastic({{15e6, x}});
     },
     0, true, true},
    {"SteepestSofteningWithoutNarrowing", "hardening.0.modulus", // E / (2 (1 - nu))
     [](double x) {
       return Plasticity{{1e9, 0}, {{15e6, x}, {12e6, 0}}, ModulusKind::plastic, true, {}};
     },
     -5e8},
    {"SteepestSofteningOfFixedVolume", "hardening.0.modulus",
     [](double x) {
       return Plasticity{{1e9, 0.5}, {{15e6, x}, {12e6, 0}}, ModulusKind::plastic, true, {}};
     },
     -1e9},
    {"Mu", "viscosity.mu",
     [](double x) {
       return plastic({{15e6, 1e6}}, false, {Overstress::peric, x, 1, {}});
     }},
    {"EpsilonFromBelow", "viscosity.epsilon",
     [](double x) {
       return plastic({{15e6, 1e6}}, false, {Overstress::peric, 1, x, {}});
     }},
    {"EpsilonFromAbove", "viscosity.epsilon",
     [](double x) {
       return plastic({{15e6, 1e6}}, false, {Overstress::peric, 1, x, {}});
     },
     10, false, true},
    {"ThresholdFromBelow", "viscosity.threshold", [](double x) { return creeping(x); }, 0, true, true},
    {"ThresholdFromAbove", "viscosity.threshold", [](double x) { return creeping(x); }, 15e6, false, true},
    {"ThresholdOfSoftening", "viscosity.threshold", [](double x) { return creeping(x, true); }, 10e6}};

INSTANTIATE_TEST_SUITE_P(Rules, RuleOfALaw, testing::ValuesIn(borders),
                         [](const auto& used) { return std::string(used.param.claim); });

// Random numbers of a seed.
struct Random {
  std::mt19937 engine{11};
  double operator()(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine); }
};

double least_eigenvalue(const Mat3& matrix) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(matrix).eigenvalues()[0];
}

TEST(Judgement, OfTwoConstantsIsThatOfTheEnergyInSpace) {
  Random random;
  for (int i = 0; i < 2000; ++i) {
    const double E = random(-1e9, 1e9), nu = random(-1.5, 1);
    Mat3 compliance; // of normal stresses; shear's is 2 (1 + nu) / E
    compliance << 1, -nu, -nu, -nu, 1, -nu, -nu, -nu, 1;
    const bool positive = least_eigenvalue(compliance / E) > 0 && (1 + nu) / E > 0;
    EXPECT_EQ(faults(StVenantKirchhoff{E, nu}).empty(), positive) << E << " " << nu;
  }
}

TEST(Judgement, OfFourConstantsIsThatOfTheTangent) {
  Random random;
  for (int i = 0; i < 2000; ++i) {
    const Orthotropic law{random(-1e8, 9e8), random(-1e8, 9e8), random(-2, 2), random(-1e8, 9e8)};
    EXPECT_EQ(faults(law).empty(), least_eigenvalue(law.stiffness()) > 0)
        << law.youngs_modulus_1 << " " << law.youngs_modulus_2 << " " << law.poissons_ratio_12;
  }
}

// Least eigenvalue of dT/db, Kirchhoff stress by logarithmic strain, over its largest entry, where a sheet is pulled to
// stretches from 1/4 to 4; from the law's own tangent: dT_i/db_j = S_ij C_i C_j + 2 T_i.
double least_stability(const Ogden& law) {
  double least = 1;
  for (const double across : {-0.5, 1.0, 0.0}) {
    for (double b = -std::log(4.0); b <= std::log(4.0); b += 0.02) {
      const Vec3 c(std::exp(2 * b), std::exp(2 * across * b), 0);
      const Response at = answer(law, strain_of(std::sqrt(c[0]), std::sqrt(c[1])));
      Mat2 slope;
      for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) {
          slope(i, j) = at.tangent(i, j) * c[i] * c[j] + (i == j ? 2 * at.stress[i] * c[i] : 0);
        }
      }
      least =
          std::min(least, Eigen::SelfAdjointEigenSolver<Mat2>(slope).eigenvalues()[0] / slope.cwiseAbs().maxCoeff());
    }
  }
  return least;
}

TEST(Judgement, OfOgdensConstantsIsThatOfTheTangentUpToFourTimesTheLength) {
  Random random;
  int unstable = 0;
  for (int i = 0; i < 300; ++i) {
    const Ogden law = ogden({{random(1e5, 1e6), random(1, 5)}, {random(-1e5, 1e5), random(-3, 3)}});
    const double least = least_stability(law);
    if (std::abs(least) < 1e-3) continue; // between two places
    EXPECT_EQ(has_error(law), least < 0) << i << " " << least;
    if (least < 0) ++unstable;
  }
  EXPECT_GT(unstable, 30);
  EXPECT_LT(unstable, 270);
}

// Solutions gamma >= 0 of the return to the yield surface (plane_stress_return.h) for a trial stress
// (s11 + s22)^2 / 4 = A, 3/4 (s11 - s22)^2 = B on or outside of it: changes of sign on a scan.
int solutions(const Elasticity& elasticity, const Flow& flow, double alpha, double A, double B) {
  const double a = 0.5 * elasticity.sum_modulus(), b = 3 * elasticity.shear_modulus();
  const auto excess = [&](double gamma) {
    const double sigma = std::sqrt(A / std::pow(1 + a * gamma, 2) + B / std::pow(1 + b * gamma, 2));
    return sigma - flow.stress(alpha, gamma * sigma, 0).value;
  };
  const bool on_surface = std::abs(excess(0)) < 1e-12 * flow.onset(alpha);
  bool outside = on_surface ? excess(1e-4 / a) > 0 : true;
  int count = on_surface ? 1 : 0;
  for (double gamma = 1e-4 / a; gamma < 1e6 / a; gamma *= 1.1) {
    if ((excess(gamma) > 0) == outside) continue;
    outside = !outside;
    ++count;
  }
  return count;
}

// The most solutions of trial stresses of any direction, on the yield surface and outside.
int most_solutions(const Elasticity& elasticity, const Flow& flow, Random& random) {
  int most = 0;
  for (const Hardening::Branch& branch : *flow.hardening.branches) {
    for (const double share : {0.0, 1.0, random(0, 1)}) {
      for (const double size : {1.0, random(1, 3)}) {
        const double squared = std::pow(size * branch.stress, 2);
        most = std::max(most, solutions(elasticity, flow, branch.alpha, share * squared, (1 - share) * squared));
      }
    }
  }
  return most;
}

TEST(Judgement, OfSofteningIsWhetherTheReturnToTheYieldSurfaceHasOneSolution) {
  Random random;
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    Plasticity law = plastic({}, true);
    law.elasticity.poissons_ratio = random(-0.9, 0.5);
    const double E = law.elasticity.youngs_modulus;
    const double steepest = -0.5 * E / (1 - law.elasticity.poissons_ratio);
    double stress = random(10e6, 20e6);
    for (int k = 0; k < 2; ++k) {
      law.hardening.push_back({stress, random(-1, 0.3) * E});
      stress *= law.hardening.back().modulus > 0 ? random(1.2, 2) : random(0.5, 0.8);
    }
    law.hardening.push_back({stress, random(0, 1e8)});
    const auto is_close = [&](const HardeningBranch& b) { return std::abs(b.modulus / steepest - 1) < 0.01; };
    if (std::any_of(law.hardening.begin(), law.hardening.end(), is_close)) continue;
    const int most = most_solutions(law.elasticity, flow_of(law), random);
    EXPECT_EQ(faults(law).empty(), most == 1) << i << ": " << most << " solutions";
    if (most > 1) ++refused;
  }
  EXPECT_GT(refused, 50);
  EXPECT_LT(refused, 250);
}

TEST(Plasticity, OfPlasticAndTangentModuliIsTheSameFlow) {
  const Plasticity law = plastic({{15e6, 72e6}, {21e6, 40e6}}, false, {Overstress::perzyna, 10, 0.5, 1.5e6});
  Plasticity by_tangent = tangent(law);
  for (HardeningBranch& b : by_tangent.hardening) b.modulus = 1 / (1 / b.modulus + 1 / law.elasticity.youngs_modulus);
  const Flow flow = flow_of(law), other = flow_of(by_tangent);
  for (const double alpha : {0.0, 0.02, 0.5}) EXPECT_NEAR(flow.onset(alpha), other.onset(alpha), 1e-7); // Pa, rounding
  EXPECT_EQ(flow.viscosity.mu, 10);
  EXPECT_EQ(flow.onset(0), 1.5e6);
  EXPECT_THROW(flow_of(plastic({{21e6, 72e6}, {15e6, 40e6}})), std::invalid_argument);
}

} // namespace
} // namespace pneuma::tests
