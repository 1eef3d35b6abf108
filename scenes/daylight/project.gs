<?xml version="1.0" encoding="UTF-8"?>
<project xmlns="http://grogra.de/registry" graph="graph.xml">
 <import plugin="de.grogra.vecmath" version="1.5"/>
 <import plugin="de.grogra.imp3d" version="1.5"/>
 <import plugin="de.grogra.math" version="1.5"/>
 <import plugin="de.grogra.pf" version="1.5"/>
 <import plugin="de.grogra.imp" version="1.5"/>
 <registry>
  <ref name="project">
   <ref name="objects">
    <ref name="3d"/>
   </ref>
  </ref>
  <ref name="workbench">
   <ref name="state">
    <de.grogra.pf.ui.registry.Layout name="layout">
     <de.grogra.pf.ui.registry.MainWindow>
      <de.grogra.pf.ui.registry.PanelFactory source="/ui/panels/3d/defaultview">
       <de.grogra.pf.registry.Option name="panelId" type="java.lang.String" value="/ui/panels/3d/defaultview"/>
       <de.grogra.pf.registry.Option name="panelTitle" type="java.lang.String" value="View"/>
       <de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="graphDescriptor=[de.grogra.imp.ProjectGraphDescriptor]visibleLayers={true true true true true true true true true true true true true true true true}epsilon=1.0E-6 visualEpsilon=0.01 magnitude=1.0 camera=(minZ=0.1 maxZ=2000.0 projection=[de.grogra.imp3d.PerspectiveProjection aspect=1.0 fieldOfView=0.75]transformation=(0.87910708 0.47662432 0.0 -0.516872596 -0.0226913149 0.0418528697 0.998866078 -1.33392435 0.476083865 -0.878110241 0.0476083865 -8.77131624 0.0 0.0 0.0 1.0))navigator=null"/>
      </de.grogra.pf.ui.registry.PanelFactory>
     </de.grogra.pf.ui.registry.MainWindow>
    </de.grogra.pf.ui.registry.Layout>
   </ref>
  </ref>
 </registry>
</project>
