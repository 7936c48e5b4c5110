// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "python/src/arrays.hpp"
#include "python/src/docs.hpp"

namespace emberfold::python {

namespace py = pybind11;

/// Returns how Python writes a value.
inline std::string repr_text(const py::handle& value) {
  return py::repr(value);
}

template <class Value>
struct Optional : std::false_type {};
template <class Value>
struct Optional<std::optional<Value>> : std::true_type {
  using Inner = Value;
};

/// Returns what a field of this type may be, in words.
template <class Value>
std::string allowed() {
  if constexpr (Optional<Value>::value) {
    return allowed<typename Optional<Value>::Inner>() + " or None";
  } else if constexpr (std::is_enum_v<Value>) {
    std::string names;
    for (const auto& [name, member] : py::type::of<Value>().attr("__members__").template cast<py::dict>())
      names += (names.empty() ? "" : ", ") + py::str(name).template cast<std::string>();
    return names;
  } else if constexpr (std::is_same_v<Value, bool>) {
    return "True or False";
  } else if constexpr (std::is_integral_v<Value>) {
    return "a whole number";
  } else if constexpr (std::is_floating_point_v<Value>) {
    return "a number";
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return "a text";
  } else if constexpr (std::is_same_v<Value, cv::Size>) {
    return "(width, height)";
  } else {
    return py::type_id<Value>();
  }
}

/// Converts the value of a field or argument. Options may be given as a dict, values of an enumeration by
/// name. ValueError, naming the field, for what does not fit.
template <class Value>
Value from_python(const py::handle& given, const std::string& name) {
  if constexpr (Optional<Value>::value) {
    if (given.is_none()) return std::nullopt;
    if constexpr (std::is_enum_v<typename Optional<Value>::Inner>)
      return from_python<typename Optional<Value>::Inner>(given, name);
  }
  if constexpr (requires(const Value& options) { options.validate(); }) {
    if (py::isinstance<py::dict>(given)) return py::type::of<Value>()(**given).template cast<Value>();
  }
  if constexpr (std::is_enum_v<Value>) {
    if (py::isinstance<py::str>(given)) {
      const py::dict members = py::type::of<Value>().attr("__members__");
      if (members.contains(given)) return members[given].template cast<Value>();
    }
  }
  try {
    return given.cast<Value>();
  } catch (const py::cast_error&) {
    throw py::value_error(name + " is " + repr_text(given) + "; allowed is " + allowed<Value>());
  }
}

/// Makes a class of a struct of options: its fields are keyword arguments, with the struct's own defaults and
/// comments; it is compared, printed and pickled by its fields.
template <class Options>
class OptionsClass {
 public:
  OptionsClass(const py::module_& scope, const char* name, std::string cpp_name)
      : name_(name), cpp_name_(std::move(cpp_name)), class_(scope, name) {}

  /// Adds the fields that Options::fields() describes.
  OptionsClass& described_fields() {
    for (const auto& one : Options::fields())
      std::visit(
          [&](const auto member) {
            const std::string unit = *one.unit == '\0' ? "" : std::string(" ") + one.unit;
            field(one.name, member,
                  one.is_switch() ? one.meaning : one.allowed() + unit + ": " + one.meaning);
          },
          one.member);
    return *this;
  }

  /// Adds one field, with its comment in the header unless a text is given.
  template <class Value, class Of>
  OptionsClass& field(const char* field_name, Value Of::*member, std::string about = {}) {
    static_assert(std::is_base_of_v<Of, Options>);
    const std::string full = name_ + "." + field_name;
    if (about.empty()) about = doc(cpp_name_ + "::" + field_name);
    fields_->push_back({field_name, about, [member, full](Options& options, const py::handle& given) {
                          options.*member = from_python<Value>(given, full);
                        }});
    class_.def_property(
        field_name, [member](Options& options) -> Value& { return options.*member; },
        [member, full](Options& options, const py::object& given) {
          options.*member = from_python<Value>(given, full);
        },
        about.c_str());
    return *this;
  }

  void finish() {
    const auto make = [fields = fields_, name = name_](const py::kwargs& given) {
      Options options;
      for (const auto& [key, value] : given) set(*fields, options, name, key, value);
      return options;
    };
    class_.def(py::init(make));
    class_.def("to_dict", to_dict, "Returns the fields and their values.");
    class_.def("__repr__", [name = name_](const py::object& self) {
      std::string text;
      for (const auto& [key, value] : to_dict(self))
        text += (text.empty() ? "" : ", ") + std::string(py::str(key)) + "=" + repr_text(value);
      return name + "(" + text + ")";
    });
    class_.def("__eq__", [](const py::object& self, const py::object& other) {
      return py::isinstance<Options>(other) && to_dict(self).equal(to_dict(other));
    });
    class_.attr("__hash__") = py::none();
    class_.def(py::pickle([](const py::object& self) { return to_dict(self); },
                          [make](const py::dict& state) { return make(py::kwargs(state)); }));
    py::tuple names(fields_->size());
    for (std::size_t i = 0; i < fields_->size(); ++i) names[i] = py::str((*fields_)[i].name);
    class_.attr("FIELDS") = names;
    class_.attr("__doc__") = text();
  }

 private:
  struct Field {
    std::string name, about;
    std::function<void(Options&, const py::handle&)> set;
  };
  using Fields = std::vector<Field>;

  static void set(const Fields& fields, Options& options, const std::string& owner, const py::handle& key,
                  const py::handle& value) {
    const auto name = key.cast<std::string>();
    for (const auto& field : fields)
      if (field.name == name) return field.set(options, value);
    throw py::value_error(owner + " has no field '" + name + "'");
  }
  static py::dict to_dict(const py::object& self) {
    py::dict fields;
    for (const auto& name : py::type::of<Options>().attr("FIELDS")) fields[name] = self.attr(name);
    return fields;
  }
  [[nodiscard]] std::string text() const {
    std::string all = doc(cpp_name_);
    all += "\n\nFields, with their defaults:\n";
    const py::object defaults = class_();
    for (const auto& field : *fields_) {
      all += "    " + field.name + " = " + repr_text(defaults.attr(field.name.c_str()));
      all += field.about.empty() ? "\n" : ": " + field.about + "\n";
    }
    return all;
  }

  std::string name_, cpp_name_;
  py::class_<Options> class_;
  std::shared_ptr<Fields> fields_ = std::make_shared<Fields>();
};

}  // namespace emberfold::python
