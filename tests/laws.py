"""One material of every law, for tests that treat all laws alike."""

from fem import Hencky, Material, MooneyRivlin, NeoHooke, Ogden, StVenantKirchhoff, Yeoh

LAWS: dict[str, Material] = {
    "svk": StVenantKirchhoff(E=1.2, nu=0.45),
    "hencky": Hencky(E=1.2, nu=0.45),
    "neo_hooke": NeoHooke(mu=0.4, kappa=3.0),
    "mooney_rivlin": MooneyRivlin(c10=0.15, c01=0.05, kappa=3.0),
    "yeoh": Yeoh(c10=0.11, c20=0.02, c30=-0.001, kappa=3.0),
    "ogden": Ogden(mu=(0.3, 0.02, -0.01), alpha=(1.3, 5.0, -2.0), kappa=3.0),
}
