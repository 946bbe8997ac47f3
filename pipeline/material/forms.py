"""What is fitted to tensile tests."""

from fem.materials import LAWS, LinearLaw
from pipeline.material.form import Form, LinearForm
from pipeline.material.ogden import OgdenForm

#: by name
FORMS: dict[str, Form] = {
    **{law: LinearForm(law, kind) for law, kind in LAWS.items() if issubclass(kind, LinearLaw)},
    **{form.name: form for form in (OgdenForm(1), OgdenForm(2), OgdenForm(3))},
}
