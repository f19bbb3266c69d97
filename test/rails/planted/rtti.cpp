// SPDX-License-Identifier: Apache-2.0
struct Base {
  virtual void Call();
};
struct Derived : Base {};
Derived* Planted(Base* base) { return dynamic_cast<Derived*>(base); }
