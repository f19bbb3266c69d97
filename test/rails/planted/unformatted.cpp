// SPDX-License-Identifier: Apache-2.0
int Planted( int value ){return value ;}
